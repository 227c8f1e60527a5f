"""Composition of the forest's shaders: every combination compiles and uses what it declares."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest

from renderer.core.errors import ShaderError
from renderer.core.params import uniform_declarations
from renderer.core.registry import techniques
from renderer.forest.program import SCOUT_BLOCKS, WORLD_DECLARATIONS, scout_source, shade_source, trace_source
from renderer.forest.state import SLOTS, ForestState, Ground
from renderer.gl.context import GL
from renderer.gl.program import declared, unused
from renderer.gl.source import assemble
from renderer.gl.thread import GLThread
from renderer.world.camera import CAMERA_DECLARATIONS
from renderer.world.sky import SKY_DECLARATIONS
from tests.forest import worlds

ALL = [(slot, kind) for slot in SLOTS for kind in techniques("forest", slot)]

SPARED: dict[str, Callable[[dict[str, str]], bool]] = {
    "sky_irradiance": lambda chosen: chosen["sky"] in {"constant", "visible_hemisphere"},
    "sun_elevation": lambda chosen: chosen["shadow"] == "none" or chosen["shadow"].endswith("shadow_map"),
    # Trees are as tall everywhere, and of all species, unless a map says otherwise.
    "growth": lambda chosen: True,
    "species": lambda chosen: True,
    "species_voxels": lambda chosen: True,
    "canopy_least": lambda chosen: chosen["geometry"] == "slices",
    "canopy_grade": lambda chosen: chosen["geometry"] == "slices",
    "pixel_angle": lambda chosen: chosen["filter"] == "none",
    "pixel_width": lambda chosen: chosen["filter"] == "none",
}
"""Uniforms of the world that no program of a combination reads, and which combinations those are."""


def left_over(gl: GL, state: ForestState, more: str = "") -> list[str]:
    """Declared uniforms that neither the trace nor the light uses."""
    vertex, idle = assemble(["stages/fullscreen.vert"]), []
    for source in (trace_source(state), shade_source(state)):
        text = "\n".join(line for line in source.text.split("\n") if line.startswith("uniform"))
        names = {*declared(text), *declared(more)}
        idle.append((names, set(unused(gl.programs.get(vertex, source), names))))
    used = set().union(*(names - left for names, left in idle))
    return sorted(set().union(*(names for names, _ in idle)) - used)


@pytest.mark.parametrize(("slot", "kind"), ALL)
def test_what_is_declared_is_used(thread: GLThread, slot: str, kind: str) -> None:
    state = worlds.state(view={"background": "sky"}, **{slot: {"kind": kind}})
    chosen = {name: technique.kind for name, technique in state.techniques().items()}
    expected = sorted(name for name, when in SPARED.items() if when(chosen))
    assert thread.call(left_over, state) == expected


def test_an_idle_uniform_is_found(thread: GLThread) -> None:
    assert thread.call(left_over, worlds.state(view={"background": "sky"}), "uniform float idle;") == [
        "growth", "idle", "species", "species_voxels"
    ]


def test_local_heights_and_species_are_read(thread: GLThread) -> None:
    maps = {"canopy_model": "asset:" + 64 * "0", "species_map": "asset:" + 64 * "0"}
    state = worlds.state(view={"background": "sky"}, cover=maps)
    assert thread.call(left_over, state) == []


def test_every_part_declares_its_own(thread: GLThread) -> None:
    """A frame declares camera, sky, world, ground, and the live parameters of every technique, once each."""
    state = worlds.state(shadow={"kind": "depth_shadow_map"})
    world = (CAMERA_DECLARATIONS, SKY_DECLARATIONS, WORLD_DECLARATIONS, uniform_declarations(Ground, "ground"))
    chosen = state.techniques()
    of_trace, of_light = ("geometry", "filter"), tuple(slot for slot in SLOTS if slot != "geometry")
    for source, slots in ((trace_source(state), of_trace), (shade_source(state), of_light)):
        for part in (*world, *(uniform_declarations(type(chosen[slot]), slot) for slot in slots)):
            for name in declared(part):
                assert len(re.findall(rf"^uniform \w+ {name};", source.text, re.MULTILINE)) == 1, name


def test_live_values_need_no_new_program() -> None:
    one = trace_source(worlds.state()), shade_source(worlds.state())
    for change in ({"shadow": {"strength": 0.3}}, {"sun": {"azimuth": 10}}, {"ground": {"tint_strength": 0.5}},
                   {"camera": {"distance": 333}}, {"geometry": {"step": 2.0}}):
        other = worlds.state(**change)
        assert trace_source(other) is one[0]
        assert shade_source(other) is one[1]
    assert shade_source(worlds.state(light={"kind": "gouraud"})) is not one[1]
    assert shade_source(worlds.state(view={"background": "sky"})).text != one[1].text


def test_light_and_shadow_are_no_part_of_the_trace() -> None:
    one = trace_source(worlds.state())
    for change in ({"shadow": {"kind": "none"}}, {"light": {"kind": "gouraud"}}, {"sky": {"kind": "constant"}},
                   {"height_shading": {"kind": "none"}}):
        assert trace_source(worlds.state(**change)) is one
    assert trace_source(worlds.state(geometry={"kind": "slices"})) is not one


def test_a_line_of_the_frame_leads_back_to_its_file() -> None:
    source = shade_source(worlds.state())
    number = next(n for n, line in enumerate(source.text.split("\n"), 1) if "float height_factor(" in line)
    file, line = source.locate(number)
    assert file == "forest/height_shading/none.glsl"
    assert line > 1


def test_an_error_in_a_technique_names_its_line(thread: GLThread, spoil: Callable) -> None:
    state = worlds.state(height_shading={"kind": "empirical"})
    file = "forest/height_shading/empirical.glsl"
    with spoil(file, "return mix(1.0,", "return mixed(1.0,"), pytest.raises(ShaderError) as failure:
        thread.call(left_over, state)
    assert failure.value.file == file
    assert failure.value.line == 7


@pytest.mark.parametrize("number", range(len(SCOUT_BLOCKS)))
def test_every_scout_compiles(thread: GLThread, number: int) -> None:
    thread.call(lambda gl: gl.programs.get(assemble(["stages/fullscreen.vert"]), scout_source(number)))
