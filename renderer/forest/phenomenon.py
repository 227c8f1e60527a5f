"""The forest as the registry finds it: its slots, presets, bakes and renderer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from renderer.core.technique import Arrays, Phenomenon, Preset, Slot
from renderer.forest.bakes import bakes
from renderer.forest.combinations import COMBINATIONS
from renderer.forest.isolating import VIEWS
from renderer.forest.probe import probe
from renderer.forest.renderer import ForestRenderer
from renderer.forest.state import DEFAULTS, ForestState
from renderer.forest.world_arrays import NEEDS, world_arrays
from renderer.world import sky
from renderer.world.sun import angles

SLOTS = (
    Slot(
        "geometry",
        "Geometry",
        "How the canopy is sampled along a ray.",
        "void geometry_trace(vec3 origin, vec3 direction, float t, vec4 jitter, inout Event event) // m",
        DEFAULTS["geometry"],
    ),
    Slot(
        "shadow",
        "Shadow",
        "Who hides the sun from whom.",
        "float shadow_visibility(vec3 position, float h, vec2 uv) // share of the sun in [0, 1]",
        DEFAULTS["shadow"],
    ),
    Slot(
        "height_shading",
        "Height shading",
        "Light by height in the canopy.",
        "float height_factor(float h) // factor, h in [0, 1]",
        DEFAULTS["height_shading"],
    ),
    Slot(
        "light",
        "Light",
        "How a leaf answers the sun.",
        "vec3 light_reflected(Matter matter, vec3 to_eye) // 1/sr: radiance per irradiance normal to the beam",
        DEFAULTS["light"],
    ),
    Slot(
        "sky",
        "Sky light",
        "How the sky lights the canopy.",
        "Skylight sky_light(Spot spot) // W m-2, on both sides of a leaf, and how much more on one of them",
        DEFAULTS["sky"],
    ),
    Slot(
        "filter",
        "Filtering",
        "Which level of the pattern a distance deserves.",
        "float filter_level(float footprint) // mip level, footprint in metres",
        DEFAULTS["filter"],
    ),
)


def _orbit(target: tuple[float, float, float], distance: float, azimuth: float, elevation: float) -> dict[str, Any]:
    return {"kind": "orbit", "target": list(target), "distance": distance, "azimuth": azimuth, "elevation": elevation}


def _sun(azimuth: float, elevation: float) -> dict[str, Any]:
    return {"kind": "direction", "azimuth": azimuth, "elevation": elevation}


def _metered_light(state: ForestState, baked: Mapping[str, Arrays]) -> float:
    """Light of sun and sky, W m-2."""
    return sky.metered_light(baked["sky"], angles(state.sun)[1])


PRESETS = {
    "noon": Preset(
        "Noon",
        "High sun over the whole valley.",
        {
            "camera": _orbit((200, 200, 280), 2300, 140, 30),
            "sun": _sun(190, 62),
            "view": {"exposure": 1.08},
            "filter": {"bias": 1.0},
        },
    ),
    "low_sun": Preset(
        "Low sun",
        "Late afternoon: long shadows from tree to tree.",
        {"camera": _orbit((1150, -300, 265), 650, 305, 15), "sun": _sun(255, 18), "view": {"exposure": 0.55}},
    ),
    "valley_sunset": Preset(
        "Valley at sunset",
        "The ridge has taken the sun from the valley floor.",
        {"camera": _orbit((1600, -900, 400), 1500, 268, 5), "sun": _sun(292, 9), "view": {"exposure": -0.4}},
    ),
    "forest_edge": Preset(
        "Forest edge",
        "A glade close by, in morning light.",
        {
            "camera": {"kind": "look", "eye": [964, 306, 81.5], "target": [975, 420, 84], "field_of_view": 50},
            "sun": _sun(160, 38),
            "view": {"exposure": 0.9},
        },
    ),
    "overcast": Preset(
        "Overcast",
        "A closed sky: no sun, and what light there is comes from above.",
        {
            "camera": _orbit((1150, -300, 265), 650, 305, 15),
            "sun": _sun(190, 45),
            "air": {"weather": "overcast"},
            "sky": {"kind": "visible_hemisphere"},
            "view": {"exposure": 0.9},
        },
    ),
    **VIEWS,
}

PHENOMENON = Phenomenon(
    name="forest",
    title="Forest",
    help="A forest of texture cells over a real terrain, under a moving sun.",
    slots=SLOTS,
    state=ForestState,
    presets=PRESETS,
    bakes=bakes,
    open=ForestRenderer,
    world=world_arrays,
    world_needs=NEEDS,
    metered_light=_metered_light,
    probe=probe,
    combinations=COMBINATIONS,
)
