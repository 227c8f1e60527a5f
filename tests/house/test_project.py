"""The project's own files agree with each other: dependencies, locks, commands, citation."""

from __future__ import annotations

import ast
import functools
import re
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parent.parent.parent
PROJECT: dict[str, Any] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
TOOLS = {"ruff", "mypy"}
"""Dependencies that the Makefile calls."""

THROUGH = {
    "websockets": "uvicorn", "python-multipart": "fastapi", "embreex": "trimesh", "imagecodecs": "tifffile",
    "tzdata": "zoneinfo", "httpx2": "starlette", "pytest-asyncio": "pytest", "pytest-timeout": "pytest",
}
"""Dependencies that another module imports on our behalf."""

MODULES = {
    "pillow": "PIL", "openexr": "OpenEXR", "prometheus-client": "prometheus_client", "flip-evaluator": "flip_evaluator",
    "axe-playwright-python": "axe_playwright_python", "pywavelets": "pywt", "pytest-xdist": "xdist",
}
"""Names of modules that are not their distribution's."""


def name_of(requirement: str) -> str:
    match = re.match(r"[A-Za-z0-9_.-]+", requirement)
    assert match is not None
    return match.group().lower()


@functools.cache
def imports(*folders: str) -> set[str]:
    """Every top-level module that the Python files of some folders import."""
    found = set()
    for path in (path for folder in folders for path in (ROOT / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                found |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                found.add(node.module.split(".")[0])
    return found


@pytest.mark.parametrize("requirement", PROJECT["dependencies"])
def test_a_dependency_is_imported(requirement: str) -> None:
    name = name_of(requirement)
    assert THROUGH.get(name) or MODULES.get(name, name) in imports("renderer", "server")
    assert THROUGH.get(name, "uvicorn") in imports("renderer", "server")


@pytest.mark.parametrize("requirement", PROJECT["optional-dependencies"]["test"])
def test_a_test_dependency_is_used(requirement: str) -> None:
    name = name_of(requirement)
    if name in TOOLS:
        assert f"$(BIN)/{name}" in (ROOT / "Makefile").read_text()
    else:
        assert THROUGH.get(name, MODULES.get(name, name)) in imports("tests", "server")


def locked(lock: str) -> dict[str, str]:
    """Version by name, of a lock file in which each must carry hashes and nothing says where it comes from."""
    text = (ROOT / "docker" / lock).read_text()
    assert "://" not in text
    assert "--index" not in text
    entries = re.findall(r"^(\S+)==(\S+)[^\n]*\\\n((?:    --hash=sha256:[0-9a-f]{64}[ \\]*\n)+)", text, re.MULTILINE)
    assert len(entries) == len(re.findall(r"^\S", text, re.MULTILINE)), "an entry without hashes"
    return {name.lower(): version for name, version, _ in entries}


def test_the_locks_hold_every_dependency() -> None:
    run, test = locked("requirements.lock"), locked("requirements-test.lock")
    assert {name_of(requirement) for requirement in PROJECT["dependencies"]} <= run.keys()
    assert {name_of(requirement) for requirement in PROJECT["optional-dependencies"]["test"]} <= test.keys()
    assert {name: test.get(name) for name in run} == run


def test_every_command_explains_itself() -> None:
    make = ["make", "--no-print-directory", "help"]
    told = subprocess.run(make, cwd=ROOT, check=True, capture_output=True, text=True)
    for command in ("run", "test", "lint", "bench", "study", "screenshots", "lock"):
        assert re.search(rf"^make {command}\s+\w", told.stdout, re.MULTILINE), command


def test_what_the_makefile_calls_is_a_command_of_the_viewer() -> None:
    from server.cli import main

    called = set(re.findall(r"\$\(BIN\)/umbrage (\w+)", (ROOT / "Makefile").read_text()))
    assert {"serve", "bench", "study"} <= called
    for command in called:
        with pytest.raises(SystemExit) as ended:
            main([command, "--help"])
        assert ended.value.code == 0, command


def test_ci_runs_what_a_person_types() -> None:
    assert (ROOT / ".ci" / "run").read_text().rstrip().endswith("exec make test")


@pytest.mark.parametrize("script", ["docker/setup.sh", ".ci/run"])
def test_scripts_parse_in_a_plain_shell(script: str) -> None:
    subprocess.run(["sh", "-n", ROOT / script], check=True)
    assert (ROOT / script).stat().st_mode & 0o111


def test_the_citation_names_the_four_works() -> None:
    text = (ROOT / "CITATION.cff").read_text()
    for word in ("inria-00598409", "hal-04138703", "Dufort", "Porquet", "Cohen", "Belcour", PROJECT["version"]):
        assert word in text, word


def test_the_changelog_knows_this_version() -> None:
    assert f"## {PROJECT['version']}" in (ROOT / "CHANGELOG.md").read_text()
