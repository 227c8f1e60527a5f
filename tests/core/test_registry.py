"""Techniques and phenomena are found by walking folders."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter

import renderer
from renderer.core import registry
from renderer.core.errors import InputError, UmbrageError

TECHNIQUE = '''
from typing import Literal
from renderer.core.technique import Technique
class {name}(Technique):
    """One technique."""
    title = caption = paper = "t"
    kind: Literal["{kind}"] = "{kind}"
'''


@pytest.fixture
def grove(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """An empty phenomenon `grove` with the slot `shadow`, in a place of its own."""
    slot = tmp_path / "renderer" / "grove" / "shadow"
    slot.mkdir(parents=True)
    (tmp_path / "shaders" / "grove" / "shadow").mkdir(parents=True)
    monkeypatch.setattr(renderer, "__path__", [*renderer.__path__, str(tmp_path / "renderer")])
    monkeypatch.setattr(registry, "SHADERS", tmp_path / "shaders")
    importlib.invalidate_caches()
    yield tmp_path
    registry.techniques.cache_clear()
    registry.phenomena.cache_clear()
    for name in [name for name in sys.modules if name.startswith("renderer.grove")]:
        del sys.modules[name]


def add(grove: Path, stem: str, kind: str = "", glsl: bool = True, text: str = "") -> None:
    (grove / "renderer/grove/shadow" / f"{stem}.py").write_text(
        text or TECHNIQUE.format(name=stem.title().replace("_", ""), kind=kind or stem))
    if glsl:
        (grove / "shaders/grove/shadow" / f"{stem}.glsl").write_text("float shadow() { return 1.0; }\n")


def test_finds_each_file_and_passes_over_helpers(grove: Path) -> None:
    add(grove, "soft")
    add(grove, "hard")
    add(grove, "soft_bake", glsl=False, text="from renderer.grove.shadow.soft import Soft\nSIZE = 3\n")
    assert list(registry.techniques("grove", "shadow")) == ["hard", "soft"]


def test_a_union_of_one_and_of_many_both_validate(grove: Path) -> None:
    add(grove, "soft")
    one: TypeAdapter[Any] = TypeAdapter(registry.slot_union("grove", "shadow"))
    assert one.validate_python({"kind": "soft"}).kind == "soft"
    registry.techniques.cache_clear()
    add(grove, "hard")
    importlib.invalidate_caches()
    many: TypeAdapter[Any] = TypeAdapter(registry.slot_union("grove", "shadow"))
    assert many.validate_python({"kind": "hard"}).kind == "hard"


def test_a_kind_that_is_not_its_files_name_is_an_error(grove: Path) -> None:
    add(grove, "soft", kind="softer")
    with pytest.raises(UmbrageError, match="its kind is 'softer'"):
        registry.techniques("grove", "shadow")


def test_a_technique_without_glsl_is_an_error(grove: Path) -> None:
    add(grove, "soft", glsl=False)
    with pytest.raises(UmbrageError, match=r"no grove/shadow/soft\.glsl"):
        registry.techniques("grove", "shadow")


def test_an_unknown_scene_is_refused_by_name() -> None:
    with pytest.raises(InputError) as refused:
        registry.phenomenon("ocean")
    assert refused.value.field == "scene"
    assert refused.value.allowed == ", ".join(registry.phenomena())
