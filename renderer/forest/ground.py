"""The forest's ground: a square of the terrain, and where trees may stand on it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.ndimage import gaussian_filter

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.technique import Arrays
from renderer.forest.world_scale import CELL, NODES, STAND_TOP
from renderer.world.terrain import DEFAULT_CENTRE, TerrainReading, crop, default_terrain, load_terrain

RIM = 3
"""Nodes along the square's edge that always bear forest."""


def square(arguments: dict[str, Any]) -> np.ndarray:
    """Elevation (N, N) float32 [m] of the document's `terrain`, row 0 the northern edge.

    Raises:
        InputError: the user's file cannot serve, naming the document's field.
    """
    if arguments["kind"] == "built_in":
        return crop(default_terrain(), DEFAULT_CENTRE, NODES * CELL, CELL).elevation
    try:
        path = AssetStore().get(arguments["asset"].removeprefix("asset:")).path
        terrain = load_terrain(path, reading=TerrainReading.model_validate(arguments["reading"]))
        return crop(terrain, (arguments["east"], arguments["north"]), NODES * CELL, CELL).elevation
    except InputError as failure:
        if failure.field in TerrainReading.model_fields:
            raise failure.at(f"terrain.reading.{failure.field}") from None
        raise failure.at("terrain.east" if failure.field == "centre" else "terrain.asset") from None


def cover_map(elevation: np.ndarray, base: float, rules: dict[str, Any]) -> np.ndarray:
    """Where trees may stand, as a smooth map (N, N) in [0, 1] whose 0.5 contour is the forest's edge.

    Args:
        elevation: height above the base [m], row 0 the northern edge. base: elevation of its zero [m].
        rules: the document's `cover`.
    """
    noise = np.random.Generator(np.random.PCG64(rules["seed"])).standard_normal(elevation.shape)
    sigma = rules["glade_size"] / CELL / 4
    field = (
        gaussian_filter(noise, sigma, mode="reflect") * sigma
        + 0.35 * gaussian_filter(noise, sigma / 3, mode="reflect") * sigma / 3
    )
    threshold = (
        np.quantile(field, rules["clearings"])
        if 0 < rules["clearings"] < 1
        else (-np.inf if rules["clearings"] == 0 else np.inf)
    )
    cover = np.clip(0.5 + (field - threshold) / max(float(field.std()), 1e-9) * 2.0, 0, 1)
    north, east = np.gradient(elevation, CELL)
    slope = np.hypot(north, east)
    steep = math.tan(math.radians(rules["steepest"]))
    cover = np.minimum(cover, np.clip(0.5 + (steep - slope) * 4, 0, 1))
    cover = np.minimum(cover, np.clip(0.5 + (rules["tree_line"] - base - elevation) / 40, 0, 1))
    # Beyond the square its edge continues for ever: let that be forest, not the streaks of a cut glade.
    cover[:RIM] = cover[-RIM:] = cover[:, :RIM] = cover[:, -RIM:] = 1.0
    return cover.astype(np.float32)


def bake_ground(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]) -> Arrays:
    """Elevation above the square's lowest point, cover, and that point's own elevation.

    Args:
        arguments: `terrain` and `cover`, as in the document.

    Returns:
        `elevation` (N, N) float32 [m], `cover` (N, N) float32, `surface` (N, N) float32 [m] with the stands' tops,
        `base` () float64 [m]; row 0 is the northern edge.
    """
    progress(0.1, "reading the terrain")
    terrain = square(arguments["terrain"])
    base = float(terrain.min())
    elevation = (terrain - base).astype(np.float32)
    progress(0.6, "laying out the forest")
    cover = cover_map(elevation, base, arguments["cover"])
    surface = elevation + np.float32(STAND_TOP) * (cover > 0.5)
    return {"elevation": elevation, "cover": cover, "surface": surface, "base": np.array(base)}
