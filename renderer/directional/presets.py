"""Named views of the directional textures."""

from __future__ import annotations

from typing import Any

from renderer.core.technique import Preset


def _camera(distance: float, azimuth: float, elevation: float, height: float) -> dict[str, Any]:
    return {
        "kind": "orbit",
        "target": [0, 0, height],
        "distance": distance,
        "azimuth": azimuth,
        "elevation": elevation,
        "field_of_view": 30,
    }


def _sun(azimuth: float, elevation: float) -> dict[str, Any]:
    return {"kind": "direction", "azimuth": azimuth, "elevation": elevation}


PRESETS = {
    "teapot": Preset(
        "Teapot",
        "Painted porcelain in the sun, by Phong's model.",
        {
            "subject": {"kind": "teapot"},
            "light": {"kind": "phong", "diffuse": 0.8, "specular": 0.2, "shininess": 120},
            "camera": _camera(4.0, 160, 24, 0.45),
            "sun": _sun(205, 42),
        },
    ),
    "dragon": Preset(
        "Dragon",
        "Its wings lay shadows on its back.",
        {
            "subject": {"kind": "dragon"},
            "camera": _camera(4.0, 140, 18, 0.75),
            "sun": _sun(215, 38),
        },
    ),
    "knot": Preset(
        "Knot",
        "A rope of three strands, knotted: it hides much of itself from the sun.",
        {"camera": _camera(4.4, 150, 30, 0.35)},
    ),
    "thesis": Preset(
        "As in the thesis",
        "Satin in 129 directions, nine bytes of shadow a point, and the nearest direction: its edges leap.",
        {
            "subject": {"kind": "teapot"},
            "visibility": {"directions": 129},
            "hemispheres": {"directions": 129},
            "selection": {"kind": "nearest"},
            "light": {"kind": "measured_brdf"},
            "material": {"kind": "satin"},
            "self_shadow": {"kind": "harmonics"},
            "camera": _camera(4.0, 160, 24, 0.45),
            "sun": _sun(205, 42),
        },
    ),
    "basket": Preset(
        "Basket",
        "A lamp shines out of it through its wicker's gaps.",
        {
            "subject": {"kind": "basket"},
            "lamp": {"lit": True, "place": [0.0, 0.0, 0.75], "intensity": 60.0},
            "camera": _camera(4.9, 150, 26, 0.95),
            "sun": _sun(230, 14),
        },
    ),
    "tree": Preset(
        "Tree",
        "Leaves are thinner than a texel: what remains of them is what the texels' middles meet.",
        {
            "subject": {"kind": "tree"},
            "light": {"kind": "phong", "specular": 0.03},
            "camera": _camera(4.4, 150, 8, 1.0),
            "sun": _sun(215, 40),
        },
    ),
    "land": Preset(
        "Land",
        "A block of land under a low sun: each point knows its own horizon.",
        {
            "subject": {"kind": "relief"},
            "light": {"kind": "phong", "specular": 0.0},
            "self_shadow": {"kind": "bits"},
            "camera": _camera(5.0, 150, 32, 0.1),
            "sun": _sun(250, 18),
        },
    ),
    "rock": Preset(
        "Rock",
        "Layers of stone in raking light.",
        {
            "subject": {"kind": "rock"},
            "light": {"kind": "phong", "specular": 0.04},
            "camera": _camera(4.6, 165, 16, 0.6),
            "sun": _sun(235, 28),
        },
    ),
    "validation": Preset(
        "Validation table",
        "Red, green and blue by the azimuth of the light from the view's: a table read by the wrong index would show.",
        {
            "subject": {"kind": "teapot"},
            "camera": _camera(3.9, 150, 22, 0.45),
            "sun": _sun(165, 40),
            "material": {"kind": "validation"},
            "view": {"exposure": -0.5},
            "light": {"kind": "measured_brdf"},
        },
    ),
    "satin": Preset(
        "Satin rope",
        "A measured table with a grain: the sheen runs across the threads.",
        {
            "camera": _camera(4.4, 150, 30, 0.35),
            "sun": _sun(165, 40),
            "material": {"kind": "satin"},
            "view": {"exposure": 0.0},
            "light": {"kind": "measured_brdf", "ambient": 0.5},
        },
    ),
    "studio": Preset(
        "Gold in a studio",
        "Sun on a table of rough metal, and a studio's soft lights in a blurred mirror: every light at once.",
        {
            "subject": {"kind": "dragon"},
            "camera": _camera(4.0, 140, 18, 0.75),
            "material": {"kind": "metal"},
            "environment": {"kind": "studio"},
            "light": {"kind": "combined", "surface": "measured", "surface_share": 0.6, "matt": 0.2},
        },
    ),
    "evening": Preset(
        "Glaze in the evening",
        "A mirror over painted matt clay: hills and an evening sky, sharp in the one and gathered by the other.",
        {
            "subject": {"kind": "teapot"},
            "camera": _camera(3.9, 150, 6, 0.45),
            "environment": {"kind": "evening", "rotation": 100.0},
            "light": {"kind": "environment"},
        },
    ),
}
