"""What holds for every file: its place, its length, its words."""

from __future__ import annotations

import ast
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent.parent
TOP = {".ci", ".gitignore", "ARCHITECTURE.md", "CHANGELOG.md", "CITATION.cff", "Makefile", "README.md", "docker",
       "docs", "pyproject.toml", "renderer", "server", "shaders", "tests", "web"}
MOST_LINES = 300
MOST_FUNCTION_LINES = 60
MOST_PAGE_BYTES = 150_000
"""Of the page's own script and style that are fetched before the first picture, as they lie here: sent as they are."""


def tracked() -> list[Path]:
    """Every file of the checkout, without what git ignores."""
    command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return sorted(path for name in listed.split("\0") if name and (path := ROOT / name).is_file())


def having(*suffixes: str) -> list[Path]:
    return [path for path in tracked() if path.suffix in suffixes]


SOURCES = having(".py", ".js", ".glsl", ".vert", ".frag", ".css")
TEXTS = [path for path in tracked() if path.suffix in {".py", ".js", ".glsl", ".vert", ".frag", ".css", ".html", ".md",
                                                       ".toml", ".yaml", ".sh", ".cff", ".lock", ".json", ".txt", ""}]


def test_the_top_level_is_fixed() -> None:
    assert {path.relative_to(ROOT).parts[0] for path in tracked()} - TOP == set()


def at_start(name: str, found: set[str] | None = None) -> set[str]:
    """A module of the page and all that it imports, without what it fetches later."""
    found = set() if found is None else found
    if name not in found:
        found.add(name)
        text = (ROOT / "web" / name).read_text()
        for inner in re.findall(r'^(?:import|export)\b[^;]*?"\./([\w.]+)";$', text, re.MULTILINE):
            at_start(inner, found)
    return found


def test_the_page_is_light() -> None:
    modules = at_start("main.js")
    styles = re.findall(r'rel="stylesheet" href="([\w.]+)"', (ROOT / "web" / "index.html").read_text())
    assert len(modules) > 15
    assert len(styles) >= 1
    assert sum((ROOT / "web" / name).stat().st_size for name in [*modules, *styles]) <= MOST_PAGE_BYTES


def test_every_file_of_the_page_is_wanted() -> None:
    texts = {path.name: path.read_text() for path in (ROOT / "web").iterdir() if path.suffix in {".js", ".html"}}
    for path in having(".js", ".css"):
        wanted = re.compile(rf'["/]{re.escape(path.name)}"')
        assert any(wanted.search(text) for name, text in texts.items() if name != path.name), path.name


def test_files_are_short() -> None:
    lengths = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in SOURCES}
    assert len(lengths) > 30
    assert {name: length for name, length in lengths.items() if length > MOST_LINES} == {}


def test_functions_are_short() -> None:
    long = {}
    for path in having(".py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                length = (node.end_lineno or node.lineno) - node.lineno + 1
                if length > MOST_FUNCTION_LINES:
                    long[f"{path.relative_to(ROOT)}:{node.name}"] = length
    assert long == {}


# Spelt so that this file holds none of what it looks for.
LOCAL = re.compile(r"(?<![\w.~/:)}-])/(?:wor" + r"k|tm" + r"p|hom" + r"e/\w+|roo" + r"t|Use" + r"rs)/\w")
UNFINISHED = re.compile(r"\b(TO" + r"DO|FIX" + r"ME|XX" + r"X|HA" + r"CK)\b")


@pytest.mark.parametrize("pattern", [LOCAL, UNFINISHED], ids=["paths of one machine", "unfinished"])
def test_no_text_holds(pattern: re.Pattern[str]) -> None:
    found = [f"{path.relative_to(ROOT)}:{number}: {line.strip()[:80]}" for path in TEXTS
             for number, line in enumerate(path.read_text().splitlines(), 1) if pattern.search(line)]
    assert found == []


@pytest.mark.parametrize("line", ["open('/wor" + "k/a')", "see /tm" + "p/x", "path=/hom" + "e/ann/x"])
def test_a_local_path_is_found(line: str) -> None:
    assert LOCAL.search(line)


def test_a_test_bears_the_name_of_what_it_tests_only_once() -> None:
    """Two test modules of one folder and name would hide each other."""
    names = [str(path) for path in having(".py") if path.name.startswith("test_")]
    assert len(names) == len(set(names)) > 5
