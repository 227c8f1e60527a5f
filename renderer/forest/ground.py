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
from renderer.forest.planting import mixed_share
from renderer.forest.stand_maps import density_map, species_map, sunward, survey
from renderer.forest.world_scale import CELL, NODES, PRESENCE_SIDE, STAND_TOP
from renderer.world.maps import spread
from renderer.world.terrain import DEFAULT_CENTRE, Terrain, TerrainReading, crop, default_terrain, load_terrain

RIM = 3
"""Nodes along the square's edge that always bear forest."""

EDGE = 3.0
"""How much faster the trees' presence falls than the cover at the forest's edge: it thins out over a row of trees."""


def square(arguments: dict[str, Any]) -> tuple[np.ndarray, Terrain]:
    """Elevation (N, N) float32 [m] of the document's `terrain`, row 0 the northern edge, and the whole model.

    Raises:
        InputError: the user's file cannot serve, naming the document's field.
    """
    if arguments["kind"] == "built_in":
        return crop(default_terrain(), DEFAULT_CENTRE, NODES * CELL, CELL).elevation, default_terrain()
    try:
        path = AssetStore().get(arguments["asset"].removeprefix("asset:")).path
        terrain = load_terrain(path, reading=TerrainReading.model_validate(arguments["reading"]))
        return crop(terrain, (arguments["east"], arguments["north"]), NODES * CELL, CELL).elevation, terrain
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
    cover = np.minimum(_glades(elevation, rules), _below_the_line(elevation, base, rules))
    return _rimmed(cover, RIM).astype(np.float32)


def _glades(elevation: np.ndarray, rules: dict[str, Any]) -> np.ndarray:
    """The cover that clearings and steep ground leave."""
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
    return np.minimum(cover, np.clip(0.5 + (steep - slope) * 4, 0, 1))


def _below_the_line(elevation: np.ndarray, base: float, rules: dict[str, Any]) -> np.ndarray:
    """The share of the trees that the tree line leaves, from 1 to 0 over its width."""
    line = rules["tree_line"] + rules["tree_line_aspect"] * sunward(elevation)
    share: np.ndarray = np.clip(0.5 + (line - base - elevation) / rules["tree_line_width"], 0, 1)
    return share


def _rimmed(cover: np.ndarray, rim: int) -> np.ndarray:
    """Beyond the square its edge continues for ever: let that be forest, not the streaks of a cut glade."""
    cover[:rim] = cover[-rim:] = cover[:, :rim] = cover[:, -rim:] = 1.0
    return cover


def presence_map(elevation: np.ndarray, base: float, rules: dict[str, Any]) -> np.ndarray:
    """Share of the stand's trees that are there, (P, P) in [0, 1]: a tree stands where its rank is below it.

    The forest is whole inside its edge and thins out over a row of trees; at the tree line, over its whole width.
    """
    share = np.clip(0.5 + EDGE * (_glades(elevation, rules) - 0.5), 0, 1)
    return spread(np.minimum(share, _below_the_line(elevation, base, rules)), PRESENCE_SIDE)


def bake_ground(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]) -> Arrays:
    """Elevation above the square's lowest point, cover, and that point's own elevation.

    Args:
        arguments: `terrain` and `cover`, as in the document; with a species map, `planted` (`nursery.listed`).
        inputs: `pattern`, where a canopy height model is given.

    Returns:
        `elevation` (N, N) float32 [m], `cover` (N, N) float32, `surface` (N, N) float32 [m] with the stands' tops,
        `presence` (P, P) uint8, the share of the pattern's trees that stand there, of 255; `growth` (N, N) float32,
        their height against the pattern's; `base` () float64 [m]; with a species map, `species` (P, P) uint8 and
        `sections` (BANDS + 1,) uint8, which of the pattern's each number has; row 0 is the northern edge.
    """
    progress(0.1, "reading the terrain")
    terrain, land = square(arguments["terrain"])
    base = float(terrain.min())
    elevation = (terrain - base).astype(np.float32)
    progress(0.6, "laying out the forest")
    rules = arguments["cover"]
    cover = cover_map(elevation, base, rules)
    presence = presence_map(elevation, base, rules)
    growth = np.ones(cover.shape, np.float32)
    if rules["canopy_model"]:
        progress(0.7, "reading the canopy heights")
        found = survey(rules, arguments["terrain"], land, inputs["pattern"])
        presence = np.where(np.isnan(found.share), presence, np.minimum(found.share, 1))
        growth = np.where(found.known, found.growth, growth).astype(np.float32)
        cover = _rimmed(np.where(found.known, _half(presence), cover), RIM).astype(np.float32)
    if rules["density_map"]:
        progress(0.8, "reading the density map")
        presence = presence * density_map(rules)
        cover = _rimmed(np.minimum(cover, _half(presence)), RIM).astype(np.float32)
    species = {}
    if rules["species_map"]:
        progress(0.9, "reading the species map")
        planted = np.array(list(arguments["planted"].values()), int)
        species = {
            "species": species_map(rules, arguments["planted"]),
            "sections": np.append(0, np.cumsum(planted) * planted).astype(np.uint8),
        }
        presence = presence * np.where(species["species"] > 0, 1.0, mixed_share(planted.sum()))
    surface = elevation + np.float32(STAND_TOP) * growth * (cover > 0.5)
    return {
        "elevation": elevation,
        "cover": cover,
        "surface": surface,
        "presence": np.rint(255 * _rimmed(presence, RIM * PRESENCE_SIDE // NODES)).astype(np.uint8),
        "growth": growth,
        **species,
        "base": np.array(base),
    }


def _half(presence: np.ndarray) -> np.ndarray:
    """Cover (N, N) of a presence (P, P): the ground counts as wooded from a third of a closed stand on."""
    rows = presence.reshape(NODES, presence.shape[0] // NODES, NODES, -1).mean(axis=(1, 3))
    found: np.ndarray = np.clip(0.5 + 2 * (rows - 1 / 3), 0, 1)
    return found
