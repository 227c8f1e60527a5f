"""Imports and includes run one way: server, session, study and phenomena, world and gl, core."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent.parent
TRUNK = {"core", "gl", "world", "reference", "study"}
PHENOMENA = {path.name for path in (ROOT / "renderer").iterdir() if path.is_dir() and path.name[0] not in "_."} - TRUNK

ALLOWED = {
    "core": set(),
    "gl": {"core"},
    "world": {"core"},
    # The truth that techniques are judged by shares no code with them.
    "reference": {"world", "core"},
    "study": {"reference", "world", "gl", "core"},
    "session": {"study", "reference", "world", "gl", "core", *PHENOMENA},
    "server": {"session", "core"},
    **{name: {"world", "gl", "core"} for name in PHENOMENA},
}
"""What each part may import, beside itself. A module right under `renderer` belongs to the session."""


def part(module: str) -> str | None:
    """The part of the house that a module belongs to; None for what is not ours."""
    names = module.split(".")
    if names[0] == "server":
        return "server"
    if names[0] != "renderer":
        return None
    return names[1] if len(names) > 1 and names[1] in TRUNK | PHENOMENA else "session"


def imported(text: str) -> Iterator[str]:
    """Every module that a Python text imports, at whatever depth."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            # `from renderer import session` imports a module, too.
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def wrong_imports(module: str, text: str) -> list[str]:
    """The imports of a text that run against the arrows."""
    own = part(module)
    assert own is not None
    # The package itself holds nothing: its folder is where the registry starts to look.
    bare = {"renderer", "renderer.__path__"}
    return [name for name in imported(text)
            if name not in bare and part(name) not in {None, own} | ALLOWED[own]]


def modules() -> list[Path]:
    return sorted([*ROOT.glob("renderer/**/*.py"), *ROOT.glob("server/**/*.py")])


@pytest.mark.parametrize("path", modules(), ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_follow_the_arrows(path: Path) -> None:
    module = ".".join(path.relative_to(ROOT).with_suffix("").parts)
    assert wrong_imports(module, path.read_text()) == []


@pytest.mark.parametrize(("module", "line"), [
    ("renderer.core.cache", "from renderer.world.camera import Orbit"),
    ("renderer.world.sky", "def f():\n    import renderer.gl.thread"),
    ("renderer.gl.program", "from renderer import forest"),
    ("renderer.reference.forest", "from renderer.forest.tiles import TABLE"),
    ("renderer.forest.program", "from renderer.session import Session"),
    ("renderer.study.charts", "import server.app"),
    ("server.app", "from renderer.gl.thread import GLThread"),
    ("renderer.session", "from server import settings"),
])
def test_a_wrong_import_is_found(module: str, line: str) -> None:
    assert len(wrong_imports(module, line)) == 1


def test_only_gl_and_what_draws_touch_the_graphics_library() -> None:
    users = {part(".".join(path.relative_to(ROOT).with_suffix("").parts)) for path in modules()
             if any(name.split(".")[0] in {"moderngl", "glcontext"} for name in imported(path.read_text()))}
    assert users <= {"gl", *PHENOMENA}


INCLUDE = re.compile(r'^\s*#include\s+"([^"]+)"', re.MULTILINE)


@pytest.mark.parametrize("path", sorted(ROOT.glob("shaders/**/*.*")), ids=lambda path: str(path.relative_to(ROOT)))
def test_shaders_include_the_library_or_their_own_phenomenon(path: Path) -> None:
    own = path.relative_to(ROOT / "shaders").parts[0]
    found = INCLUDE.findall(path.read_text())
    assert [name for name in found if name.split("/")[0] not in {"lib", own}] == []
    assert [name for name in found if not (ROOT / "shaders" / name).is_file()] == []
