"""The whole Earth's albedo, for what lies beyond the site's own ground: coasts as they are, colours by climate.

`land.png` is the share of land in each quarter of a degree (1440 x 720, row 0 at the north pole, column 0 at 180
degrees west), averaged from the GLOBE elevation model's mask at 30 seconds of arc (GLOBE Task Team 1999, public
domain; packed by T. Karin 2019, global-land-mask, MIT licence).

Deviations: the colours are no survey. Land is forest, steppe, desert, tundra or ice by its latitude and by eleven known
deserts; seasons, soils and cities are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

LAND = Path(__file__).parent / "land.png"

OCEAN = (0.045, 0.060, 0.085)
"""Albedo of deep water under a high sun (Payne 1972: 0.06 in the mean), bluer by what it scatters back."""

FOREST, STEPPE, DESERT, TUNDRA, ICE = (
    (0.045, 0.075, 0.035),
    (0.15, 0.15, 0.085),
    (0.40, 0.32, 0.21),
    (0.16, 0.15, 0.12),
    (0.80, 0.82, 0.84),
)
"""Albedo of each kind of land by band: broadband means of Oke 1987, table 1.1, with the colour of each."""

DESERTS = (
    (23.0, 5.0, 10.0, 24.0), (24.0, 29.0, 8.0, 10.0), (23.0, 47.0, 9.0, 9.0), (31.0, 58.0, 6.0, 9.0),
    (40.0, 62.0, 6.0, 9.0), (42.0, 100.0, 6.0, 18.0), (-25.0, 128.0, 8.0, 14.0), (-23.0, 19.0, 7.0, 5.0),
    (34.0, -112.0, 7.0, 6.0), (-23.0, -69.0, 9.0, 2.5), (-44.0, -69.0, 7.0, 3.0),
)  # fmt: skip
"""Sahara (west, east), Arabia, Iran, Karakum, Gobi, Australia, Namib and Kalahari, Sonora and Mojave, Atacama,
Patagonia: latitude and longitude of the middle and half the extent along each, degrees."""


def bake_globe(
    arguments: dict[str, Any],
    inputs: Mapping[str, Mapping[str, np.ndarray]],
    progress: Callable[[float, str], None],
) -> dict[str, np.ndarray]:
    """Albedo of the Earth.

    Returns:
        `albedo` (720, 1440, 3) uint8, its square root times 255: dark land keeps its steps; row 0 at the SOUTH pole.
    """
    progress(0.1, "colouring the globe")
    with Image.open(LAND) as image:
        land = np.asarray(image, dtype=np.float64) / 255.0
    rows, columns = land.shape
    latitude = 90.0 - (np.arange(rows) + 0.5) * 180.0 / rows
    longitude = (np.arange(columns) + 0.5) * 360.0 / columns - 180.0
    albedo = np.array(OCEAN) + land[..., None] * (_climates(latitude, longitude) - np.array(OCEAN))
    albedo = _over(albedo, ICE, _sea_ice(latitude)[:, None] * (1.0 - land))
    progress(1.0, "globe ready")
    return {"albedo": np.rint(255.0 * np.sqrt(albedo[::-1])).astype(np.uint8)}


def _climates(latitude: np.ndarray, longitude: np.ndarray) -> np.ndarray:
    """Albedo of dry land, (rows, columns, 3)."""
    shape = (len(latitude), len(longitude))
    away = np.broadcast_to(np.abs(latitude)[:, None], shape)
    north = np.broadcast_to(latitude[:, None], shape)
    colour = np.broadcast_to(np.array(FOREST), (*shape, 3))
    colour = _over(colour, STEPPE, _band(away, 14.0, 22.0) * (1.0 - _band(away, 42.0, 54.0)))
    colour = _over(colour, DESERT, _dry(latitude, longitude))
    colour = _over(colour, TUNDRA, _band(away, 60.0, 70.0))
    greenland = (north > 60.0) & (longitude > -58.0) & (longitude < -20.0)
    return _over(colour, ICE, np.maximum(_band(away, 74.0, 82.0), np.maximum(greenland, _band(-north, 60.0, 66.0))))


def _dry(latitude: np.ndarray, longitude: np.ndarray) -> np.ndarray:
    """How much of a desert each place is, (rows, columns) in [0, 1]."""
    dry = np.zeros((len(latitude), len(longitude)))
    for middle, across, tall, wide in DESERTS:
        apart = np.hypot((latitude[:, None] - middle) / tall, (longitude - across) / wide)
        dry = np.maximum(dry, 1.0 - _band(apart, 0.6, 1.25))
    return dry


def _sea_ice(latitude: np.ndarray) -> np.ndarray:
    """Share of the sea that is frozen, in the mean of the seasons."""
    return np.maximum(_band(latitude, 74.0, 84.0), _band(-latitude, 64.0, 70.0))


def _band(value: np.ndarray, low: float, high: float) -> np.ndarray:
    t = np.clip((value - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _over(below: np.ndarray, colour: tuple[float, ...], share: np.ndarray) -> np.ndarray:
    return below + share[..., None] * (np.array(colour) - below)
