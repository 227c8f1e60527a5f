"""Named views of the clouds."""

from __future__ import annotations

from typing import Any

from renderer.core.technique import Preset


def _look(eye: tuple[float, float, float], target: tuple[float, float, float], field_of_view: float) -> dict[str, Any]:
    return {"kind": "look", "eye": list(eye), "target": list(target), "field_of_view": field_of_view}


def _sun(azimuth: float, elevation: float) -> dict[str, Any]:
    return {"kind": "direction", "azimuth": azimuth, "elevation": elevation}


PRESETS = {
    "sea_of_clouds": Preset(
        "Sea of clouds",
        "From an aeroplane, late in the afternoon.",
        {"camera": _look((0, -9000, 4200), (0, 0, 2900), 45), "sun": _sun(300, 22)},
    ),
    "valley": Preset(
        "Valley under stratocumulus",
        "From a ridge, with the shadows of the clouds on the hills.",
        {
            "camera": _look((-6000, -7000, 900), (0, 0, 900), 55),
            "sun": _sun(240, 40),
            "clouds": {"kind": "procedural", "cover": 0.6},
        },
    ),
    "space": Preset(
        "The Earth from space",
        "Day and night from 20,000 km.",
        {
            "camera": {
                "kind": "orbit",
                "target": [0, 0, -6.35e6],
                "distance": 2.6e7,
                "azimuth": 180,
                "elevation": 70,
                "field_of_view": 32,
            },
            "sun": _sun(110, 40),
            "layer": {"thickness": 250.0},
        },
    ),
}
