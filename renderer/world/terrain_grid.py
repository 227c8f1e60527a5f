"""What a terrain is, what its file may leave unsaid, and what is refused or repaired.

Row 0 is the northern edge, x runs east and y north, elevations and cell sizes are metres. Nodes are samples, not areas.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from scipy import ndimage

from renderer.core.errors import AssetError, LimitError
from renderer.core.params import Model, Vector2, param
from renderer.world.limits import DEFAULT_LIMITS, Limits
from renderer.world.terrain_crs import Crs, place

MAX_ELEVATION = 30_000.0
"""Metres either way: the deepest trench is 11 km, the highest volcano known (on Mars) 22 km. More is no metre."""

CELL_RANGE = (0.01, 10_000.0)
"""Metres between nodes, from a scanned rock to a continent's model."""

SWEEPS = 120
"""Relaxations a level: on a plane, a hole of 100 x 200 nodes then errs by 0.4 % of the drop across it."""

Holes = Literal["refuse", "fill"]


class TerrainReading(Model):
    """What a terrain file may leave unsaid. A size of 0 means: as the file says."""

    cell_size: Vector2 = param(
        (0.0, 0.0),
        label="Cell size",
        help="Distance between nodes along x and y; 0 takes the file's own.",
        unit="m",
        cost="bake",
    )
    elevation_low: float = param(
        0.0,
        label="Lowest elevation",
        help="Elevation that the darkest value of a picture stands for.",
        unit="m",
        cost="bake",
        ge=-MAX_ELEVATION,
        le=MAX_ELEVATION,
    )
    elevation_high: float = param(
        0.0,
        label="Highest elevation",
        help="Elevation that the brightest value of a picture stands for.",
        unit="m",
        cost="bake",
        ge=-MAX_ELEVATION,
        le=MAX_ELEVATION,
    )
    holes: Holes = param(
        "refuse",
        label="Holes",
        help="Whether nodes without a value are refused, or filled with the smooth "
        "surface (Laplace's equation) that their rim spans.",
        cost="bake",
    )


@dataclass(frozen=True)
class Terrain:
    """One elevation model.

    Args:
        elevation: (rows, columns) float32, metres, row 0 at the northern edge.
        cell_size: (dx, dy) in metres; they may differ.
        origin: x and y of node (0, 0), in units of `crs`.
        crs: the file's coordinate system, kept for export; None where there is none.
        latitude, longitude: of the centre, degrees; None where unknown.
        notes: what was assumed or repaired while reading, in words.
    """

    elevation: np.ndarray
    cell_size: tuple[float, float]
    origin: tuple[float, float] = (0.0, 0.0)
    crs: Crs | None = None
    latitude: float | None = None
    longitude: float | None = None
    notes: tuple[str, ...] = ()

    @property
    def size(self) -> tuple[float, float]:
        """Distance between the outermost nodes along x and y, metres."""
        rows, columns = self.elevation.shape
        return (columns - 1) * self.cell_size[0], (rows - 1) * self.cell_size[1]


def checked(terrain: Terrain, limits: Limits = DEFAULT_LIMITS, holes: Holes = "refuse") -> Terrain:
    """`terrain` if it is one, its holes filled where asked.

    Raises:
        AssetError: naming `cell_size` or `elevation`, and where the first bad node is.
        LimitError: more nodes than the limit.
    """
    for name, length in zip(("dx", "dy"), terrain.cell_size, strict=True):
        if not (math.isfinite(length) and CELL_RANGE[0] <= length <= CELL_RANGE[1]):
            raise AssetError("cell_size", f"{name} is {length:g} m", f"{CELL_RANGE[0]:g} to {CELL_RANGE[1]:g} m")
    elevation = terrain.elevation
    check_shape(elevation.shape, limits)
    elevation = np.ascontiguousarray(elevation, dtype=np.float32)
    if np.isinf(elevation).any():
        raise AssetError("elevation", f"is infinite at {_where(np.isinf(elevation))}", "finite metres")
    missing = np.isnan(elevation)
    notes = terrain.notes
    if missing.any():
        if holes == "refuse":
            raise AssetError(
                "elevation",
                f"has {int(missing.sum()):,} holes, the first at {_where(missing)}",
                "a value at every node, or holes = fill",
            )
        elevation = fill_holes(elevation, missing)
        notes += (f"{int(missing.sum()):,} holes were filled from their rims",)
    extreme = np.abs(elevation) > MAX_ELEVATION
    if extreme.any():
        raise AssetError(
            "elevation",
            f"is {float(elevation[extreme][0]):g} m at {_where(extreme)}",
            f"-{MAX_ELEVATION:g} to {MAX_ELEVATION:g} m",
        )
    return replace(terrain, elevation=elevation, notes=notes)


def check_shape(shape: tuple[int, ...], limits: Limits) -> None:
    """Refuse a grid that is no terrain by its shape alone, before any of it is decoded."""
    if len(shape) != 2:
        raise AssetError("elevation", f"has {len(shape)} dimensions of shape {tuple(shape)}", "rows x columns")
    if min(shape) < 2:
        raise AssetError("elevation", f"has {shape[0]} x {shape[1]} nodes, which span no surface", "at least 2 x 2")
    if shape[0] * shape[1] > limits.cells:
        raise LimitError("elevation", f"has {shape[0]:,} x {shape[1]:,} nodes", f"at most {limits.cells:,} in all")


def _where(mask: np.ndarray) -> str:
    row, column = np.unravel_index(int(np.argmax(mask)), mask.shape)
    return f"row {row}, column {column}"


def fill_holes(elevation: np.ndarray, missing: np.ndarray) -> np.ndarray:
    """Elevations with the holes filled by the smooth surface that their rims span.

    Laplace's equation on the missing nodes, the known ones fixed, solved from coarse to fine: each level starts from
    the next coarser one, so that SWEEPS are enough whatever the hole's size.

    Args:
        elevation: (rows, columns) metres; values under `missing` are ignored.
        missing: (rows, columns) bool.

    Raises:
        AssetError: no node has a value.
    """
    if missing.all():
        raise AssetError("elevation", "has no value at any node", "finite metres")
    known = np.where(missing, 0.0, elevation.astype(np.float64))
    return _membrane(known, missing).astype(np.float32)


def _membrane(values: np.ndarray, missing: np.ndarray) -> np.ndarray:
    rows, columns = values.shape
    if not missing.any():
        return values
    if min(rows, columns) < 3:
        return np.where(missing, values[~missing].mean(), values)
    padded = ((0, rows % 2), (0, columns % 2))
    weight = np.pad((~missing).astype(np.float64), padded)
    total = np.pad(values, padded) * weight
    blocks = (weight.shape[0] // 2, 2, weight.shape[1] // 2, 2)
    counts = weight.reshape(blocks).sum(axis=(1, 3))
    coarse = total.reshape(blocks).sum(axis=(1, 3)) / np.maximum(counts, 1)
    coarse = _membrane(coarse, counts == 0)
    row = (np.arange(rows) - 0.5) / 2
    column = (np.arange(columns) - 0.5) / 2
    guess = ndimage.map_coordinates(coarse, np.meshgrid(row, column, indexing="ij"), order=1, mode="nearest")
    result = np.where(missing, guess, values)
    at_row, at_column = np.nonzero(missing)
    north, south = np.maximum(at_row - 1, 0), np.minimum(at_row + 1, rows - 1)
    west, east = np.maximum(at_column - 1, 0), np.minimum(at_column + 1, columns - 1)
    for _ in range(SWEEPS):
        result[at_row, at_column] = 0.25 * (
            result[north, at_column] + result[south, at_column] + result[at_row, west] + result[at_row, east]
        )
    return result


def placed(terrain: Terrain) -> Terrain:
    """`terrain` with the latitude and longitude of its centre, where its coordinate system gives them."""
    if terrain.crs is None:
        return terrain
    width, height = terrain.size
    spot = place(
        terrain.crs,
        terrain.origin[0] + 0.5 * width / terrain.crs.unit[0],
        terrain.origin[1] - 0.5 * height / terrain.crs.unit[1],
    )
    return terrain if spot is None else replace(terrain, latitude=spot[0], longitude=spot[1])
