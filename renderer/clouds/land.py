"""The land around the site: a square of an elevation model that comes down to the sphere at its edge."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.ndimage import maximum_filter

from renderer.clouds.world_scale import LAND_CELL, LAND_NODES, LAND_RIM
from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.technique import Arrays
from renderer.world.horizon_sweep import sweep, sweeps
from renderer.world.terrain import TerrainReading, crop, default_terrain, load_terrain

LEVEL = 0.005
"""Rise over run of summits over the layer that hide nothing of the sun yet."""

HORIZON_AZIMUTHS = 64
"""Azimuths in which the land's horizon is kept."""


def bake_land(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]) -> Arrays:
    """Height above the square's lowest point, and how steep it is.

    Args:
        arguments: the document's `land`.

    Returns:
        `height` (N, N) float32 [m], row 0 the SOUTHERN edge, nodes `LAND_CELL` apart around the site, 0 at the edge;
        `top` () the highest [m]; `horizon` (A, N / 2, N / 2) float32
        [-], the sine of the elevation of the land's horizon towards A azimuths clockwise from north, at the means of
        2 x 2 nodes; `open` (N / 2, N / 2) [-], the share of an even sky's light that reaches each.
    """
    progress(0.1, "reading the land")
    height = np.zeros((LAND_NODES, LAND_NODES)) if arguments["kind"] == "flat" else _square(arguments)
    nodes = (np.arange(LAND_NODES) - (LAND_NODES - 1) / 2) * LAND_CELL
    inside = LAND_NODES * LAND_CELL / 2 - np.abs(nodes)
    t = np.clip(inside / LAND_RIM, 0.0, 1.0)
    rim = t * t * (3.0 - 2.0 * t)
    height = (height * rim[:, None] * rim[None, :]).astype(np.float32)
    return {
        "height": height[::-1].copy(),
        "top": np.array(float(height.max())),
        "horizon": (horizon := _horizons(height, progress)),
        "open": _open(height, horizon),
    }


def horizon_towards(land: Arrays, azimuth: float) -> np.ndarray:
    """Sine of the horizon's elevation towards an azimuth [rad], (N / 2, N / 2), between the two nearest of the bake."""
    horizon = land["horizon"]
    place = azimuth / (2 * math.pi) * len(horizon) % len(horizon)
    low = int(place)
    share = np.float32(place - low)
    found: np.ndarray = horizon[low] + share * (horizon[(low + 1) % len(horizon)] - horizon[low])
    return found


def horizon_of_layer(land: Arrays, azimuth: float, altitude: float) -> np.ndarray:
    """Sine of the elevation at which summits hide an azimuth [rad] from the layer of clouds at an altitude [m], (N / 2,
    N / 2); -1 where none does: that of the higher of land and layer, which nothing below the layer changes."""
    size = LAND_NODES // 2
    if float(land["top"]) <= altitude:
        return np.full((size, size), -1.0, np.float32)
    slopes = sweep(np.maximum(_coarse(land["height"]), altitude)[::-1], (2 * LAND_CELL, 2 * LAND_CELL), azimuth)[::-1]
    hidden = np.maximum(slopes, 0.0)
    return np.where(hidden > LEVEL, np.sin(np.arctan(hidden)), -1.0).astype(np.float32)


def _horizons(height: np.ndarray, progress: Callable[[float, str], None]) -> np.ndarray:
    coarse = _coarse(height)
    azimuths = [2 * math.pi * k / HORIZON_AZIMUTHS for k in range(HORIZON_AZIMUTHS)]
    found = np.empty((HORIZON_AZIMUTHS, *coarse.shape), np.float32)
    for number, slopes in sweeps(coarse, (2 * LAND_CELL, 2 * LAND_CELL), azimuths):
        progress(0.2 + 0.8 * number / HORIZON_AZIMUTHS, "horizon of the land")
        found[number] = np.sin(np.arctan(np.maximum(slopes, -1.0)))[::-1]
    return found


def _open(height: np.ndarray, horizon: np.ndarray) -> np.ndarray:
    """Share of an even sky's light that a slope catches.

    Dozier and Frew 1990, equation 7b: the mean over azimuths of cos S cos^2 H + sin S cos(azimuth) (pi/2 - H - sin H
    cos H), with the slope S and the horizon's elevation H.
    """
    coarse = _coarse(height)[::-1]
    north, east = np.gradient(coarse, 2 * LAND_CELL)
    level = 1.0 / np.sqrt(1.0 + north**2 + east**2)
    seen = np.zeros_like(level)
    for number, sine in enumerate(horizon):
        azimuth = 2 * math.pi * number / len(horizon)
        h = np.maximum(sine, 0.0)
        downhill = -(east * math.sin(azimuth) + north * math.cos(azimuth)) * level
        seen += level * (1 - h**2) + downhill * (math.pi / 2 - np.arcsin(h) - h * np.sqrt(1 - h**2))
    return np.clip(seen / len(horizon), 0.0, 1.0).astype(np.float32)


def _coarse(height: np.ndarray) -> np.ndarray:
    # Sums of strided pictures: a mean over two axes at once takes six times as long.
    rows = height[::2].astype(np.float64) + height[1::2]
    return np.asarray(0.25 * (rows[:, ::2] + rows[:, 1::2]))


def tops(height: np.ndarray) -> list[np.ndarray]:
    """The highest land of each node's cell (N, N) [m], whose heights its neighbours have a part in, and then of each
    2 x 2 cells, down to one."""
    levels = [maximum_filter(height, 3, mode="nearest").astype(np.float32)]
    while len(levels[-1]) > 1:
        half = len(levels[-1]) // 2
        levels.append(levels[-1].reshape(half, 2, half, 2).max(axis=(1, 3)))
    return levels


def _square(arguments: dict[str, Any]) -> np.ndarray:
    """Heights above the lowest point, row 0 the northern edge."""
    side = LAND_NODES * LAND_CELL
    if arguments["kind"] == "built_in":
        found = crop(default_terrain(), (0.0, 0.0), side, LAND_CELL).elevation
    else:
        found = _own(arguments, side)
    return arguments["relief"] * (found - found.min()).astype(np.float64)


def _own(arguments: dict[str, Any], side: float) -> np.ndarray:
    try:
        path = AssetStore().get(arguments["asset"].removeprefix("asset:")).path
        terrain = load_terrain(path, reading=TerrainReading.model_validate(arguments["reading"]))
        return crop(terrain, (arguments["east"], arguments["north"]), side, LAND_CELL).elevation
    except InputError as failure:
        if failure.field in TerrainReading.model_fields:
            raise failure.at(f"land.reading.{failure.field}") from None
        raise failure.at("land.east" if failure.field == "centre" else "land.asset") from None
