"""The shells as the registry finds them: their slots, presets, bakes and renderer."""

from __future__ import annotations

from collections.abc import Mapping

from renderer.core.technique import Arrays, Phenomenon, Slot
from renderer.shells.bakes import bakes
from renderer.shells.outline import outline
from renderer.shells.presets import PRESETS
from renderer.shells.probe import probe
from renderer.shells.renderer import ShellsRenderer
from renderer.shells.state import DEFAULTS, ShellsState
from renderer.shells.world_arrays import NEEDS, world_arrays
from renderer.world import sky
from renderer.world.sun import angles

SLOTS = (
    Slot(
        "order",
        "Order",
        "In which order the segments of a ray are put together.",
        "the functions of its own stages: order_walk goes through cells, order_gathered says what a drawn cell leaves",
        DEFAULTS["order"],
    ),
    Slot(
        "sampling",
        "Sampling",
        "How a segment of a ray reads the texture.",
        "void sampling_segment(Ray ray, Segment segment, inout vec4 sum) // premultiplied, front to back",
        DEFAULTS["sampling"],
    ),
    Slot(
        "light",
        "Light",
        "How matter answers the light.",
        "vec3 light_source(Ray ray, float distance, vec3 place, float level, Matter matter, mat3 gradients); "
        "vec3 light_base(vec3 point, vec3 normal, bool sunlit, vec3 colour) // W m-2 sr-1",
        DEFAULTS["light"],
    ),
    Slot(
        "shadow",
        "Shadow",
        "What the shell leaves of the sun.",
        "float shadow_visibility(vec3 point) // share of the sun at a place, m from the shell's middle",
        DEFAULTS["shadow"],
    ),
    Slot(
        "filter",
        "Filter",
        "Which level of the texture is read.",
        "float filter_level(float distance, mat3 gradients); // 0 is the finest; "
        "float filter_extinction(float own, vec3 place, float level) // 1/m, along the segment that was found last",
        DEFAULTS["filter"],
    ),
    Slot(
        "accumulation",
        "Accumulation",
        "How precisely colours are put together.",
        "vec4 accumulation_kept(vec4 sum) // what the number format keeps of it",
        DEFAULTS["accumulation"],
    ),
)


def _metered_light(state: ShellsState, baked: Mapping[str, Arrays]) -> float:
    """Light of sun and sky on open ground, W m-2."""
    if state.light.kind == "unlit":
        return float(3.14159265 * state.light.level)
    return sky.metered_light(baked["sky"], angles(state.sun)[1])


PHENOMENON = Phenomenon(
    name="shells",
    title="Shells",
    help="Semi-transparent 3D textures in a shell over any surface: fur, stones, wicker, clouds.",
    slots=SLOTS,
    state=ShellsState,
    presets=PRESETS,
    bakes=bakes,
    open=ShellsRenderer,
    world=world_arrays,
    world_needs=NEEDS,
    metered_light=_metered_light,
    probe=probe,
    place=2,
    outline=outline,
)
