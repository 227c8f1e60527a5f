"""Elevation models: reading one, the default one, its heights and normals, and the square that a scene stands on.

Row 0 is the northern edge, x runs east and y north, elevations and cell sizes are metres.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
from scipy import ndimage

from renderer.core.errors import AssetError, LimitError
from renderer.world.limits import DEFAULT_LIMITS, Limits
from renderer.world.terrain_crs import Crs
from renderer.world.terrain_files import read_raster
from renderer.world.terrain_grid import Terrain, TerrainReading, checked, placed

__all__ = [
    "DEFAULT_CENTRE",
    "Terrain",
    "TerrainReading",
    "crop",
    "default_terrain",
    "height_at",
    "load_terrain",
    "normal_at",
    "normals",
]

DEFAULT_CENTRE = (2656.0, -9312.0)
"""Metres east and north of the default terrain's centre: the middle of the 4,096 m square of the default scene.

Chosen by measurement among the squares 256 m apart, on 32 m cells: the best sum of standard scores of relief (1 to
99 %), mean slope and share of the ground that other ground hides from a sun 12 degrees high (mean of 7 azimuths, east
through south to west). It has 699 m, 18.6 degrees and 45 %; the median square has 364 m, 15.5 degrees and 34 %. Of the
dozen squares that tie for the best, it has the most relief.
"""

MAX_CROP = 8192
"""Nodes along a side of the square that a scene may stand on."""


@cache
def default_terrain() -> Terrain:
    """The real elevation model that ships in matplotlib's wheel: the Jacksboro fault, Tennessee and Kentucky.

    344 x 403 nodes, 236 to 1,076 m. Its cells are 1/1200 degree; metres follow matplotlib's own example (111,200 m a
    degree, longitude by the cosine of the latitude stored as `ymin`), as `dx = 74.266 m`, `dy = 92.667 m`: 0.5 % off
    the ellipsoid, kept so that measurements on this model can be compared with those of others.
    """
    from matplotlib import cbook  # half a second to import, which only this function should cost

    with np.load(cbook.get_sample_data("jacksboro_fault_dem.npz", asfileobj=False), allow_pickle=False) as data:
        elevation = data["elevation"].astype(np.float32)
        step = (float(data["dx"]), float(data["dy"]))
        west, north = float(data["xmin"]), float(data["ymin"])
    elevation.flags.writeable = False
    unit = (111_200.0 * math.cos(math.radians(north)), 111_200.0)
    crs = Crs(epsg=4326, geographic=True, unit=unit)
    terrain = Terrain(elevation, (step[0] * unit[0], step[1] * unit[1]), (west, north), crs)
    return placed(terrain)


def load_terrain(path: Path, limits: Limits = DEFAULT_LIMITS, reading: TerrainReading | None = None) -> Terrain:
    """Read a terrain from a GeoTIFF, a 16-bit PNG or an .npz; the content decides, not the name.

    Args:
        path: the file.
        limits: bounds on its size.
        reading: what the file leaves unsaid, and what to do with holes.

    Raises:
        AssetError, LimitError: naming `file`, `elevation`, `cell_size` or `elevation_high`, in words.
    """
    reading = reading or TerrainReading()
    terrain = read_raster(path, limits, reading)
    if reading.cell_size != (0.0, 0.0):
        terrain = replace(terrain, cell_size=reading.cell_size)
    return placed(checked(terrain, limits, reading.holes))


def crop(terrain: Terrain, centre: tuple[float, float], side: float, cell: float) -> Terrain:
    """A square of the terrain, resampled bicubically to square cells.

    Cubic B-splines through the nodes; where the new cells are coarser than the old ones, the old nodes are first
    smoothed by a Gaussian of half the excess, so that no ridge between two new nodes aliases. Outside the terrain its
    edge continues.

    Args:
        terrain: the whole model.
        centre: (east, north) of the square's centre from the terrain's centre, metres.
        side: width of the square, metres; it gets round(side / cell) nodes a side.
        cell: distance between nodes, metres.

    Raises:
        AssetError: the centre lies outside the terrain, or the square has fewer than 2 nodes a side.
        LimitError: more than 8192 nodes a side.
    """
    for name, value in (("cell_size", cell), ("side", side)):
        if not (math.isfinite(value) and value > 0):
            raise AssetError(name, f"of the square is {value:g} m", "more than 0 m")
    count = round(side / cell)
    if count < 2:
        raise AssetError(
            "cell_size", f"of {cell:g} m leaves {count} nodes on a side of {side:g} m", "at least 2 nodes a side"
        )
    if count > MAX_CROP:
        raise LimitError(
            "cell_size", f"of {cell:g} m needs {count:,} nodes on a side of {side:g} m", f"at most {MAX_CROP:,}"
        )
    width, height = terrain.size
    if not (abs(centre[0]) <= width / 2 and abs(centre[1]) <= height / 2):
        raise AssetError(
            "centre",
            f"({centre[0]:g}, {centre[1]:g}) m lies outside the terrain",
            f"within {width / 2:.0f} m east or west and {height / 2:.0f} m north or south of its centre",
        )
    rows, columns = terrain.elevation.shape
    dx, dy = terrain.cell_size
    offset = (np.arange(count) - (count - 1) / 2) * cell
    column = (centre[0] + offset) / dx + (columns - 1) / 2
    row = (rows - 1) / 2 - (centre[1] - offset) / dy
    elevation = _resample(
        terrain.elevation, row, column, (max(0.0, (cell / dy - 1) / 2), max(0.0, (cell / dx - 1) / 2))
    )
    unit = terrain.crs.unit if terrain.crs else (1.0, 1.0)
    origin = (terrain.origin[0] + column[0] * dx / unit[0], terrain.origin[1] - row[0] * dy / unit[1])
    return placed(replace(terrain, elevation=elevation, cell_size=(cell, cell), origin=origin))


def _resample(elevation: np.ndarray, row: np.ndarray, column: np.ndarray, blur: tuple[float, float]) -> np.ndarray:
    """Values at fractional rows x columns; only the window that they touch is filtered. `blur` in source nodes."""
    windows = []
    for index, positions, sigma in ((0, row, blur[0]), (1, column, blur[1])):
        margin = 16 + math.ceil(4 * sigma)  # a cubic spline's memory decays by 0.27 a node: 1e-9 after 16
        last = elevation.shape[index] - 1
        start = min(max(math.floor(positions[0]) - margin, 0), last - 1)
        stop = max(min(math.ceil(positions[-1]) + margin + 1, last + 1), start + 2)
        windows.append(slice(start, stop))
    window = elevation[windows[0], windows[1]].astype(np.float64)
    if max(blur) > 0:
        window = ndimage.gaussian_filter(window, blur, mode="nearest")
    at = np.meshgrid(row - windows[0].start, column - windows[1].start, indexing="ij")
    return ndimage.map_coordinates(window, at, order=3, mode="nearest").astype(np.float32)


def normals(elevation: np.ndarray, cell_size: tuple[float, float]) -> np.ndarray:
    """Unit normals at the nodes: central differences, one-sided at the edges.

    Args:
        elevation: (rows, columns) metres, row 0 at the north.
        cell_size: (dx, dy) metres.

    Returns:
        (rows, columns, 3) float64, x east, y north, z up.
    """
    down, right = np.gradient(elevation.astype(np.float64), cell_size[1], cell_size[0])
    result = np.stack([-right, down, np.ones_like(right)], axis=-1)  # rows run south, so d/dy = -d/drow
    return result / np.linalg.norm(result, axis=-1, keepdims=True)


def _bilinear(grid: np.ndarray, cell_size: tuple[float, float], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Values of `grid` (rows, columns, ...) at points (metres) around its centre; outside, its edge continues."""
    rows, columns = grid.shape[:2]
    column = np.clip(np.asarray(x, dtype=np.float64) / cell_size[0] + (columns - 1) / 2, 0, columns - 1)
    row = np.clip((rows - 1) / 2 - np.asarray(y, dtype=np.float64) / cell_size[1], 0, rows - 1)
    left, top = np.minimum(column.astype(int), columns - 2), np.minimum(row.astype(int), rows - 2)
    extra = (1,) * (grid.ndim - 2)
    u, v = (column - left).reshape(column.shape + extra), (row - top).reshape(row.shape + extra)
    north = grid[top, left] * (1 - u) + grid[top, left + 1] * u
    south = grid[top + 1, left] * (1 - u) + grid[top + 1, left + 1] * u
    return north * (1 - v) + south * v


def height_at(elevation: np.ndarray, cell_size: tuple[float, float], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Height of the ground between nodes: bilinear, the edge's value continued outside.

    Args:
        elevation: (rows, columns) metres.
        cell_size: (dx, dy) metres.
        x, y: arrays of one shape, metres east and north of the grid's centre.

    Returns:
        metres, float64, of the shape of `x`.
    """
    return _bilinear(elevation.astype(np.float64), cell_size, x, y)


def normal_at(elevation: np.ndarray, cell_size: tuple[float, float], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Unit normal of the ground between nodes: the nodes' normals interpolated bilinearly and normalised.

    Args, returns: as `height_at`, with a last axis of 3.
    """
    result = _bilinear(normals(elevation, cell_size), cell_size, x, y)
    return result / np.linalg.norm(result, axis=-1, keepdims=True)
