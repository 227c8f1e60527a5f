"""Composition of the forest's shaders: every combination compiles and uses what it declares."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from renderer.core.params import uniform_declarations
from renderer.core.registry import techniques
from renderer.forest.program import WORLD_DECLARATIONS, frame_source, scout_source
from renderer.forest.state import SLOTS, Ground
from renderer.gl.context import GL
from renderer.gl.program import declared, unused
from renderer.gl.source import assemble
from renderer.gl.thread import GLThread
from renderer.world.camera import CAMERA_DECLARATIONS
from renderer.world.sky import SKY_DECLARATIONS
from tests.forest import worlds

ALL = [(slot, kind) for slot in SLOTS for kind in techniques("forest", slot)]

SPARED = {
    # what a world's uniform is for -> when no chosen technique asks for it
    "sky_irradiance": lambda chosen: chosen["sky"] == "constant",
    "sun_elevation": lambda chosen: chosen["shadow"] in ("none", "depth_shadow_map"),
    "pixel_angle": lambda chosen: chosen["filter"] == "none",
    "pixel_width": lambda chosen: chosen["filter"] == "none",
}
"""Uniforms of the world that a combination may leave alone, and which combinations do."""


def left_over(gl: GL, state: object, spoiled: str = "") -> list[str]:
    """Declared uniforms that the composed program does not use."""
    source = frame_source(state)  # type: ignore[arg-type]
    text = "\n".join(line for line in source.text.split("\n") if line.startswith("uniform"))
    program = gl.programs.get(assemble(["stages/fullscreen.vert"]), source)
    return unused(program, [*declared(text), *declared(spoiled)])


@pytest.mark.parametrize(("slot", "kind"), ALL)
def test_what_is_declared_is_used(thread: GLThread, slot: str, kind: str) -> None:
    state = worlds.state(view={"background": "sky"}, **{slot: {"kind": kind}})
    chosen = {name: technique.kind for name, technique in state.techniques().items()}
    expected = {name for name, when in SPARED.items() if when(chosen)}
    assert set(thread.call(left_over, state)) == expected


def test_an_idle_uniform_is_found(thread: GLThread) -> None:
    assert thread.call(left_over, worlds.state(view={"background": "sky"}), "uniform float idle;") == ["idle"]


def test_every_part_declares_its_own(thread: GLThread) -> None:
    """A frame declares camera, sky, world, ground, and the live parameters of every technique, once each."""
    state = worlds.state(shadow={"kind": "depth_shadow_map"})
    text = frame_source(state).text
    for part in (CAMERA_DECLARATIONS, SKY_DECLARATIONS, WORLD_DECLARATIONS, uniform_declarations(Ground, "ground"),
                 *(uniform_declarations(type(t), slot) for slot, t in state.techniques().items())):
        for name in declared(part):
            assert len(re.findall(rf"^uniform \w+ {name};", text, re.MULTILINE)) == 1, name


def test_live_values_need_no_new_program() -> None:
    one = frame_source(worlds.state())
    for change in ({"shadow": {"softness": 7.0}}, {"sun": {"azimuth": 10}}, {"ground": {"tint_strength": 0.5}},
                   {"camera": {"distance": 333}}):
        assert frame_source(worlds.state(**change)) is one
    assert frame_source(worlds.state(light={"kind": "gouraud"})) is not one
    assert frame_source(worlds.state(view={"background": "sky"})).text != one.text


def test_a_line_of_the_frame_leads_back_to_its_file() -> None:
    source = frame_source(worlds.state())
    number = next(n for n, line in enumerate(source.text.split("\n"), 1) if "float height_factor(" in line)
    file, line = source.locate(number)
    assert file == "forest/height_shading/empirical.glsl"
    assert line > 1


def test_an_error_in_a_technique_names_its_line(thread: GLThread, spoil: Callable) -> None:
    from renderer.core.errors import ShaderError

    state = worlds.state(height_shading={"kind": "empirical"})
    file = "forest/height_shading/empirical.glsl"
    with spoil(file, "return mix(1.0,", "return mixed(1.0,"), pytest.raises(ShaderError) as failure:
        thread.call(left_over, state)
    assert failure.value.file == file
    assert failure.value.line == 7


def test_the_scout_compiles(thread: GLThread) -> None:
    thread.call(lambda gl: gl.programs.get(assemble(["stages/fullscreen.vert"]), scout_source()))
