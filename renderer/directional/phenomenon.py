"""The directional textures as the registry finds them: their slots, presets, bakes and renderer."""

from __future__ import annotations

from collections.abc import Mapping

from renderer.core.technique import Arrays, Phenomenon, Slot
from renderer.directional.bakes import bakes, world_bakes
from renderer.directional.presets import PRESETS
from renderer.directional.probe import probe
from renderer.directional.renderer import DirectionalRenderer
from renderer.directional.state import DEFAULTS, DirectionalState, coarse
from renderer.directional.world_arrays import NEEDS, world_arrays
from renderer.world import sky
from renderer.world.sun import angles

SLOTS = (
    Slot(
        "selection",
        "Selection",
        "Which points are seen.",
        "void selection_points(int face, vec3 place, vec3 to_eye, vec2 range, out uvec4 points, out vec4 weights) "
        "// place on the face, m from the middle of the box; range, where along its ray points may lie, m",
        DEFAULTS["selection"],
    ),
    Slot(
        "light",
        "Light",
        "How points answer the light.",
        "vec3 light_radiance(Surfel surfel, vec3 to_eye) // W m-2 sr-1",
        DEFAULTS["light"],
    ),
    Slot(
        "self_shadow",
        "Self-shadow",
        "What the subject hides from itself.",
        "float self_shadow_visibility(Surfel surfel, vec3 towards) // share in [0, 1] of a distant light",
        DEFAULTS["self_shadow"],
    ),
)


def _metered_light(state: DirectionalState, baked: Mapping[str, Arrays]) -> float:
    """Light of sun and sky on open ground, W m-2."""
    return sky.metered_light(baked["sky"], angles(state.sun)[1])


PHENOMENON = Phenomenon(
    name="directional",
    title="Directional textures",
    help="A cloud of points drawn from what the faces of its box see, and lit point by point.",
    slots=SLOTS,
    state=DirectionalState,
    presets=PRESETS,
    bakes=bakes,
    open=DirectionalRenderer,
    world=world_arrays,
    world_needs=NEEDS,
    metered_light=_metered_light,
    probe=probe,
    place=3,
    world_bakes=world_bakes,
    coarse=coarse,
)
