"""Named views of the clouds."""

from __future__ import annotations

import math
from typing import Any

from renderer.clouds.world_scale import PLANET_RADIUS
from renderer.core.technique import Preset

AHEAD = 1.0e4
"""Distance at which a camera's target stands, m."""


def _look(eye: tuple[float, float, float], target: tuple[float, float, float], field_of_view: float) -> dict[str, Any]:
    return {"kind": "look", "eye": list(eye), "target": list(target), "field_of_view": field_of_view}


def _orbit(
    target: tuple[float, float, float], distance: float, azimuth: float, elevation: float, field_of_view: float
) -> dict[str, Any]:
    return {
        "kind": "orbit",
        "target": list(target),
        "distance": distance,
        "azimuth": azimuth,
        "elevation": elevation,
        "field_of_view": field_of_view,
    }


def _towards(height: float, azimuth: float, elevation: float, field_of_view: float) -> dict[str, Any]:
    """A camera over the site that looks along a direction, degrees."""
    az, el = math.radians(azimuth), math.radians(elevation)
    target = (
        AHEAD * math.sin(az) * math.cos(el),
        AHEAD * math.cos(az) * math.cos(el),
        height + AHEAD * math.sin(el),
    )
    return _look((0.0, 0.0, height), (round(target[0], 1), round(target[1], 1), round(target[2], 1)), field_of_view)


def _sun(azimuth: float, elevation: float) -> dict[str, Any]:
    return {"kind": "direction", "azimuth": azimuth, "elevation": elevation}


def _clouds(**given: Any) -> dict[str, Any]:
    return {"kind": "procedural", **given}


_OCEAN = {"planet": {"albedo": [0.03, 0.04, 0.055]}, "land": {"kind": "flat"}}

PRESETS = {
    "sea_of_clouds": Preset(
        "Sea of clouds",
        "Summits stand out of a closed layer into the first sun.",
        {
            "camera": _orbit((0, 0, 1400), 14250, 219.3, 4.4, 40),
            "sun": _sun(130, 15),
            "view": {"exposure": -0.7},
            "layer": {"base": 1250.0, "thickness": 180.0},
            "clouds": _clouds(style="stratus", cover=1.0, variation=0.35, side=24000.0, cell_size=1200.0),
            "land": {"kind": "built_in", "relief": 4.0},
            "planet": {"snow_line": 1900.0},
        },
    ),
    "valley": Preset(
        "Valley under stratocumulus",
        "Shadows of clouds on the hills below.",
        {
            "camera": _orbit((0, 0, 500), 11450, 142.1, 5.0, 50),
            "sun": _sun(30, 38),
            "view": {"exposure": 0.2},
            "layer": {"base": 2600.0, "thickness": 150.0},
            "clouds": _clouds(cover=0.45, side=32000.0, seed=4),
            "land": {"kind": "built_in", "relief": 2.5},
            "planet": {"albedo": [0.07, 0.085, 0.045], "steepest": 40.0},
        },
    ),
    "fogbow": Preset(
        "Fogbow",
        "From an aeroplane, away from the sun: a white bow, and a glory in its middle.",
        {
            "camera": _towards(3600.0, 0.0, -12.0, 95.0),
            "sun": _sun(180, 28),
            "view": {"exposure": 0.0},
            "layer": {"thickness": 30.0},
            "clouds": _clouds(style="stratus", cover=1.0, variation=0.35, side=48000.0, cell_size=3000.0),
            **_OCEAN,
        },
    ),
    "glory": Preset(
        "Glory",
        "Coloured rings round the shadow of one's own head, on a thin layer.",
        {
            "camera": _towards(3000.0, 0.0, -40.0, 15.0),
            "sun": _sun(180, 40),
            "view": {"exposure": 0.2},
            "layer": {"thickness": 25.0, "relief": 0.15},
            "clouds": _clouds(cover=1.0, variation=0.4, side=12000.0, cell_size=700.0),
            **_OCEAN,
        },
    ),
    "silver_lining": Preset(
        "Silver lining",
        "A cloud before the sun: its thin edge sends on what its middle keeps.",
        {
            "camera": _look((0, 0, 600), (700, 10000, 5200), 30),
            "sun": _sun(6.5, 30.5),
            "view": {"exposure": -1.2},
            "layer": {"thickness": 350.0},
            "clouds": _clouds(style="stratus", cover=0.55, side=48000.0, cell_size=5000.0, seed=5),
        },
    ),
    "sunset_below": Preset(
        "Lit from below",
        "The sun has set for the ground, and lights the base of the clouds from beyond their front.",
        {
            "camera": _look((-6000, -7000, 900), (-16000, -7500, 2400), 50),
            "sun": _sun(268, -0.8),
            "view": {"exposure": -2.0},
            "layer": {"thickness": 200.0, "ends": 80000.0, "ends_azimuth": 268.0},
            "clouds": _clouds(cover=0.9, variation=0.8, side=32000.0),
        },
    ),
    "snow_stratus": Preset(
        "Stratus over snow",
        "Light goes to and fro between snow and clouds.",
        {
            "camera": _orbit((0, 0, 900), 11420, 142.1, 3.0, 50),
            "sun": _sun(120, 28),
            "view": {"exposure": -0.4},
            "layer": {"base": 2700.0, "thickness": 90.0},
            "clouds": _clouds(style="stratus", cover=0.85, side=48000.0, cell_size=4000.0),
            "land": {"kind": "built_in", "relief": 4.0},
            "planet": {"snow_line": 300.0},
        },
    ),
    "space": Preset(
        "The Earth from space",
        "Day and night from 20,000 km.",
        {
            "camera": _orbit((0, 0, -PLANET_RADIUS), 2.635e7, 150.0, 60.0, 32.0),
            "sun": _sun(110, 40),
            "view": {"exposure": 0.0},
            "layer": {"thickness": 200.0},
            "clouds": _clouds(seed=5),
        },
    ),
    "limb": Preset(
        "Limb",
        "From a station at 400 km: the air as a blue line.",
        {
            "camera": _look((0, 300000, 393000), (300000, 2300000, -260000), 50),
            "sun": _sun(250, 35),
            "view": {"exposure": -0.4},
            "layer": {"thickness": 120.0},
            "clouds": _clouds(seed=5),
            "planet": {"latitude": 33.0, "longitude": -40.0},
        },
    ),
}
