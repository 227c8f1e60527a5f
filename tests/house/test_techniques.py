"""A technique is one Python file, one GLSL file of pure functions and one test, all of the same stem."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Literal

import pytest

from renderer.core import registry
from renderer.core.params import facts, param, uniform_declarations
from renderer.core.technique import Technique

ROOT = Path(__file__).parent.parent.parent
SHADERS = ROOT / "shaders"
TECHNIQUES = [(name, slot.name, kind) for name, phenomenon in registry.phenomena().items() for slot in phenomenon.slots
              for kind in registry.techniques(name, slot.name)]
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
STAGED = re.compile(r"\bvoid\s+main\s*\(|^\s*#\s*version\b|\buniform\b", re.MULTILINE)


def of_techniques() -> list[Path]:
    """The GLSL files that lie in a slot's folder."""
    found = (path for path in SHADERS.glob("*/*/*.glsl") if path.relative_to(SHADERS).parts[0] not in {"lib", "stages"})
    return sorted(found)


def named(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize(("phenomenon", "slot", "kind"), TECHNIQUES)
def test_has_its_glsl_and_its_test(phenomenon: str, slot: str, kind: str) -> None:
    assert (SHADERS / registry.glsl_file(phenomenon, slot, kind)).is_file()
    assert (ROOT / "tests" / phenomenon / slot / f"test_{kind}.py").is_file()


@pytest.mark.parametrize(("phenomenon", "slot", "kind"), TECHNIQUES)
def test_says_what_it_is_and_whose(phenomenon: str, slot: str, kind: str) -> None:
    technique = registry.techniques(phenomenon, slot)[kind]
    assert technique.title
    assert technique.caption
    # Leaving a slot empty is nobody's method.
    assert kind == "none" or re.search(r"\b(19|20)\d\d\b", technique.paper), "the paper's year"


@pytest.mark.parametrize("path", of_techniques(), ids=named)
def test_glsl_belongs_to_a_technique(path: Path) -> None:
    """Its stem is a technique's kind, or that with the name of a pass: `depth_shadow_map_depth`."""
    phenomenon, slot = path.relative_to(SHADERS).parts[:2]
    kinds = list(registry.techniques(phenomenon, slot))
    assert any(path.stem == kind or path.stem.startswith(f"{kind}_") for kind in kinds), kinds


def staged(text: str) -> list[str]:
    """What a file of pure functions must not hold."""
    return [found.strip() for found in (match.group() for match in STAGED.finditer(COMMENT.sub("", text)))]


@pytest.mark.parametrize("path", of_techniques() + sorted(SHADERS.glob("lib/*.glsl")), ids=named)
def test_glsl_is_pure_functions(path: Path) -> None:
    assert staged(path.read_text()) == []


@pytest.mark.parametrize("path", [path for path in of_techniques() if path.stem != "none"], ids=named)
def test_glsl_says_where_it_comes_from(path: Path) -> None:
    """The header names author and year, and the symbols of the paper in the code's words and units."""
    header = path.read_text().split("\n\n")[0]
    assert header.startswith("//")
    assert re.search(r"\b(19|20)\d\d\b", header), "author and year"
    assert "Symbols:" in header


@pytest.mark.parametrize(("text", "found"), [
    ("// no uniform here\nfloat f(float x) { return x; }", []),
    ("/* void main() */ vec3 mainly;", []),
    ("#version 330\nfloat f;", ["#version"]),
    ("float f;\nvoid main () {}", ["void main ("]),
    ("  uniform float a;", ["uniform"]),
])
def test_the_check_of_purity_bites(text: str, found: list[str]) -> None:
    assert staged(text) == found


def unused(technique: type[Technique], slot: str, texts: list[str]) -> list[str]:
    """Live and build parameters of a technique that no function of its GLSL reads."""
    words = set(re.findall(r"\w+", COMMENT.sub("", "\n".join(texts))))
    live = re.findall(r"^uniform \w+ (\w+);", uniform_declarations(technique, slot), re.MULTILINE)
    build = [f"{slot}_{name}".upper() for name, field in technique.model_fields.items()
             if facts(field).get("cost") == "build"]
    return [name for name in [*live, *build] if name not in words]


@pytest.mark.parametrize(("phenomenon", "slot", "kind"), TECHNIQUES)
def test_every_parameter_reaches_the_glsl(phenomenon: str, slot: str, kind: str) -> None:
    """A control that changes nothing misleads; what only Python reads is declared with the cost `host`."""
    folder = SHADERS / phenomenon / slot
    texts = [path.read_text() for path in (folder / f"{kind}.glsl", *folder.glob(f"{kind}_*.glsl"))]
    assert unused(registry.techniques(phenomenon, slot)[kind], slot, texts) == []


def test_an_unused_parameter_is_found() -> None:
    class Idle(Technique):
        """A technique with two parameters."""

        kind: Literal["idle"] = "idle"
        read: float = param(1.0, label="Read", help="Is read.")
        left: float = param(1.0, label="Left", help="Is only spoken of.")
        count: int = param(1, label="Count", help="Is read, too.", cost="build")

    text = "// shadow_left\nfloat f() { return shadow_read * SHADOW_COUNT; }"
    assert unused(Idle, "shadow", [text]) == ["shadow_left"]
