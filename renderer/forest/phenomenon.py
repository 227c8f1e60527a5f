"""The forest as the registry finds it: its slots, presets, bakes and renderer."""

from __future__ import annotations

from renderer.core.technique import Phenomenon, Preset, Slot
from renderer.forest.bakes import bakes
from renderer.forest.renderer import ForestRenderer
from renderer.forest.state import DEFAULTS, ForestState

SLOTS = (
    Slot(
        "geometry",
        "Geometry",
        "How the canopy is sampled along a ray.",
        "void geometry_trace(vec3 origin, vec3 direction, float t, float jitter, vec3 shift, inout Events events) // m",
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
        "float light_factor(vec3 voxel_normal, vec3 ground_normal) // cosine-like, >= 0",
        DEFAULTS["light"],
    ),
    Slot(
        "sky",
        "Sky light",
        "How the sky lights the canopy.",
        "vec3 sky_light(float ambient) // W m-2, ambient in [0, 1]",
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

PRESETS = {
    "noon": Preset(
        "Noon",
        "High sun over the whole valley.",
        {
            "camera": {
                "kind": "orbit",
                "target": [0, 0, 260],
                "distance": 1500,
                "azimuth": 215,
                "elevation": 28,
                "field_of_view": 40,
            },
            "sun": {"kind": "direction", "azimuth": 190, "elevation": 62},
        },
    ),
    "low_sun": Preset(
        "Low sun",
        "Late afternoon: long shadows from tree to tree.",
        {
            "camera": {
                "kind": "orbit",
                "target": [150, -100, 250],
                "distance": 700,
                "azimuth": 160,
                "elevation": 18,
                "field_of_view": 42,
            },
            "sun": {"kind": "direction", "azimuth": 255, "elevation": 16},
        },
    ),
    "valley_sunset": Preset(
        "Valley at sunset",
        "The ridge has taken the sun from the valley floor.",
        {
            "camera": {
                "kind": "orbit",
                "target": [0, 200, 240],
                "distance": 2100,
                "azimuth": 140,
                "elevation": 14,
                "field_of_view": 38,
            },
            "sun": {"kind": "direction", "azimuth": 292, "elevation": 7},
            "view": {"exposure": -5.2},
        },
    ),
    "forest_edge": Preset(
        "Forest edge",
        "A glade close by, in morning light.",
        {
            "camera": {
                "kind": "orbit",
                "target": [0, 0, 240],
                "distance": 130,
                "azimuth": 200,
                "elevation": 9,
                "field_of_view": 50,
            },
            "sun": {"kind": "direction", "azimuth": 110, "elevation": 34},
        },
    ),
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
)
