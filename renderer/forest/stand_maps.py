"""What a user's own maps say of the forest over the terrain's square: how dense, how tall, and of which species."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy import ndimage

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError, InputError
from renderer.core.technique import Arrays
from renderer.forest.canopy_horizon import solid_tops
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, NODES, PRESENCE_CELL, PRESENCE_SIDE
from renderer.world.maps import load_map, spread
from renderer.world.terrain import Terrain, TerrainReading, load_terrain

NEIGHBOURHOOD = 8.0
"""Standard deviation [m] of the window in which a survey's canopy is summed up: about a crown's width, so that the gaps
between crowns, which the pattern has of its own, are no glades."""

SHORTEST, TALLEST = 0.15, 4.0
"""Least and greatest height of a stand against the pattern's own; crowns keep their width."""

THINNEST = 0.05
"""Share of closed canopy below which a survey's noise is taken for open land."""


@dataclass(frozen=True)
class Survey:
    """A canopy height model over the square.

    Attributes:
        known: (N, N) bool, whether the model covers the node.
        share: (P, P) canopy's share against a closed stand of the pattern, NaN where unknown.
        growth: (N, N) height against the pattern's own.
    """

    known: np.ndarray
    share: np.ndarray
    growth: np.ndarray


def stored(asset: str, field: str) -> Path:
    """The file of an `asset:HASH`.

    Raises:
        InputError: it is not there, naming the document's field.
    """
    try:
        return AssetStore().get(asset.removeprefix("asset:")).path
    except InputError as failure:
        raise failure.at(field) from None


def density_map(rules: dict[str, Any]) -> np.ndarray:
    """Density (P, P) in [0, 1] of the document's `cover.density_map`, stretched over the square; row 0 the north.

    Raises:
        InputError: naming `cover.density_map` or `cover.density_full`.
    """
    try:
        values, full = load_map(stored(rules["density_map"], "cover.density_map"), "density")
    except InputError as failure:
        raise failure.at("cover.density_map") from None
    full = rules["density_full"] or full
    if values.min() < 0 or values.max() > full * 1.0001:
        raise AssetError(
            "cover.density_full",
            f"is {full:g}, where the map has values from {values.min():g} to {values.max():g}",
            "the value that means a closed forest, as 100 for per cent; negative values mean nothing",
        )
    return np.clip(spread(values / full, PRESENCE_SIDE), 0, 1)


def species_map(rules: dict[str, Any], listed: dict[str, bool]) -> np.ndarray:
    """Numbers (P, P) uint8 of the document's `cover.species_map`, stretched over the square: of the nearest pixel, from
    1 the one of `listed` that stands there, 0 where all do; row 0 the north.

    Args:
        rules: the document's `cover`. listed: names in order, and whether any of it is planted.

    Raises:
        InputError: naming `cover.species_map`.
    """
    field = "cover.species_map"
    try:
        values, _ = load_map(stored(rules["species_map"], field), "species")
    except InputError as failure:
        raise failure.at(field) from None
    meant = ", ".join(f"{number} {name}" for number, name in enumerate(listed, start=1))
    found = np.unique(values)
    wrong = found[(found != np.rint(found)) | (found < 0) | (found > len(listed))]
    if len(wrong):
        raise AssetError(field, f"has the value {wrong[0]:g}", f"0 where all are mixed, {meant}")
    for number, (name, planted) in enumerate(listed.items(), start=1):
        if number in found and not planted:
            raise AssetError(field, f"has the value {number}, but canopy.{name} is 0", f"a weight above 0 for {name}")
    row, column = ((np.arange(PRESENCE_SIDE) + 0.5) * length // PRESENCE_SIDE for length in values.shape)
    nearest: np.ndarray = values[np.ix_(row.astype(int), column.astype(int))].astype(np.uint8)
    return nearest


def stand_of(pattern: Arrays, lowest: float) -> tuple[float, float]:
    """Closed canopy's share of the ground, and the mean height [m] of its surface, in a pattern as it grows."""
    opacity = pattern["colour"][..., 3].astype(np.float32) / np.float32(255)
    tops = solid_tops(opacity, CANOPY_HEIGHT / len(opacity))
    canopy = tops > lowest
    return float(canopy.mean()), float(tops[canopy].mean()) if canopy.any() else CANOPY_HEIGHT


def survey(rules: dict[str, Any], terrain: dict[str, Any], land: Terrain, pattern: Arrays) -> Survey:
    """What the document's `cover.canopy_model` says, on the square of `terrain`.

    The model lies by its coordinates where it and the land name the same coordinate system, otherwise its centre on the
    land's centre (the square's, of the built-in land).

    Args:
        rules: the document's `cover`. terrain: the document's `terrain`. land: its whole model.
        pattern: whose trees are to become as tall as the model says.

    Raises:
        InputError: the model cannot serve, naming the document's field.
    """
    field = "cover.canopy_model"
    try:
        model = load_terrain(
            stored(rules["canopy_model"], field), reading=TerrainReading.model_validate(rules["canopy_reading"])
        )
    except InputError as failure:
        named = f"cover.canopy_reading.{failure.field}" if failure.field in TerrainReading.model_fields else field
        raise failure.at(named) from None
    lowest = float(rules["lowest_tree"])
    heights = model.elevation.astype(np.float64)
    if heights.max() < lowest:
        raise AssetError(field, f"has nothing higher than {heights.max():g} m", "heights above the ground in metres")
    if np.quantile(heights, 0.5) > 120:
        raise AssetError(
            field,
            f"has a median of {np.quantile(heights, 0.5):g} m: is it an elevation model?",
            "heights of the canopy above the ground, in metres",
        )
    centre = _centre(model, terrain, land)
    canopy = (heights > lowest).astype(np.float64)
    sigma = NEIGHBOURHOOD / np.array(model.cell_size[::-1])
    near = ndimage.gaussian_filter(canopy, sigma, mode="nearest")
    tall = ndimage.gaussian_filter(heights * canopy, sigma, mode="nearest")
    closed, own = stand_of(pattern, lowest)
    fine = _rows_columns(model, centre, PRESENCE_SIDE, PRESENCE_CELL)
    share = np.where(_inside(model, fine), _sampled(near, fine), np.nan) / closed
    nodes = _rows_columns(model, centre, NODES, CELL)
    weight = _sampled(near, nodes)
    growth = np.where(weight > THINNEST, _sampled(tall, nodes) / np.maximum(weight, 1e-9) / own, np.nan)
    return Survey(_inside(model, nodes), np.where(share < THINNEST, 0.0, share), _carried(growth))


def _centre(model: Terrain, terrain: dict[str, Any], land: Terrain) -> tuple[float, float]:
    """The square's centre, metres east and north of the model's centre."""
    if terrain["kind"] == "built_in":
        return 0.0, 0.0
    east, north = float(terrain["east"]), float(terrain["north"])
    if model.crs is None or land.crs is None or not model.crs.epsg or model.crs.epsg != land.crs.epsg:
        return east, north
    middles = [
        (grid.origin[0] * grid.crs.unit[0] + grid.size[0] / 2, grid.origin[1] * grid.crs.unit[1] - grid.size[1] / 2)
        for grid in (land, model)
        if grid.crs is not None
    ]
    return east + middles[0][0] - middles[1][0], north + middles[0][1] - middles[1][1]


def _rows_columns(
    model: Terrain, centre: tuple[float, float], count: int, cell: float
) -> tuple[np.ndarray, np.ndarray]:
    """Fractional rows (count,) and columns (count,) of the model at a square grid of places."""
    offset = (np.arange(count) - (count - 1) / 2) * cell
    rows, columns = model.elevation.shape
    row = (rows - 1) / 2 - (centre[1] - offset) / model.cell_size[1]
    return row, (centre[0] + offset) / model.cell_size[0] + (columns - 1) / 2


def _inside(model: Terrain, places: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    rows, columns = model.elevation.shape
    row, column = places
    found: np.ndarray = ((row > -0.5) & (row < rows - 0.5))[:, None] & ((column > -0.5) & (column < columns - 0.5))
    return found


def _sampled(grid: np.ndarray, places: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    at = np.meshgrid(*places, indexing="ij")
    return np.asarray(ndimage.map_coordinates(grid, at, order=1, mode="nearest"))


def _carried(growth: np.ndarray) -> np.ndarray:
    """Heights carried from the stands into the open land between them, so that they change smoothly everywhere."""
    missing = np.isnan(growth)
    if missing.all():
        return np.ones_like(growth)
    _, at = ndimage.distance_transform_edt(missing, return_indices=True)
    carried = np.clip(growth[tuple(at)], SHORTEST, TALLEST)
    softened: np.ndarray = ndimage.gaussian_filter(carried, 2.0, mode="nearest")
    return np.where(missing, softened, carried)


def sunward(elevation: np.ndarray) -> np.ndarray:
    """How much a slope faces the south, in [-1, 1]: 0 on level ground, 1 on a southern slope of 45 degrees or more."""
    to_south, _ = np.gradient(elevation, CELL)  # rows run south
    return np.clip(-to_south / math.tan(math.radians(45)), -1, 1)
