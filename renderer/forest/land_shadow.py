"""How high the land's own shadow stands over every node for one sun: what hides the sun from treetops."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from renderer.core.technique import Arrays
from renderer.forest.world_scale import CELL

NIGHT = 1e6
"""Height [m] of the shadow when the sun is not up."""

FLOOR = 30.0
"""Depth [m] under the ground below which no ray is followed."""


@njit(cache=True, nogil=True)
def _sweep(heights, cell, azimuth, tangent, result):
    """Height of the shadow's upper side, walking away from the sun along lines of its azimuth.

    Lines run along the azimuth, one for each row or column they start from, and carry the highest ray so far down with
    them; a node between two lines takes the mean of both, weighted by nearness. Nothing is interpolated twice.

    Args:
        heights: (N, M) [m], row 0 the northern edge. cell: side of a cell [m]. azimuth: of the sun [rad].
        tangent: of its elevation. result: (N, M) float32.

    Source: Dozier, Bruno & Downey 1981 (lines along the azimuth); one elevation needs no hull, only the highest ray.
    """
    east, south = math.sin(azimuth), -math.cos(azimuth)
    along_rows = abs(south) >= abs(east)
    grid = heights if along_rows else heights.T
    out = result if along_rows else result.T
    major, minor = (south, east) if along_rows else (east, south)
    length, width = grid.shape
    drift = -minor / abs(major)
    fall = cell / abs(major) * tangent
    extent = math.ceil(abs(drift) * (length - 1)) + 1
    high = np.full(width + 2 * extent, -1e9)
    out[:] = np.float32(0.0)
    for walked in range(length):
        row = length - 1 - walked if major > 0 else walked
        moved = drift * walked
        whole = math.floor(moved)
        share = moved - whole
        for line in range(high.shape[0]):
            low = line - extent + whole
            if low < -1 or low >= width:
                high[line] -= fall
                continue
            here = (1 - share) * grid[row, max(low, 0)] + share * grid[row, min(low + 1, width - 1)]
            # Without the node itself, for this falls evenly to where it meets the ground between two nodes.
            passing = max(high[line] - fall, here - FLOOR)
            high[line] = max(passing, here)
            if low >= 0:
                out[row, low] += np.float32((1 - share) * passing)
            if low + 1 < width:
                out[row, low + 1] += np.float32(share * passing)


def shadow_height(heights: np.ndarray, cell: float, azimuth: float, elevation: float) -> np.ndarray:
    """Height [m] below which the sun is hidden, at every node, by others than itself.

    Args:
        heights: (N, M) [m], row 0 the northern edge. cell: side of a cell [m].
        azimuth, elevation: of the sun [rad], clockwise from north, from the horizontal.

    Returns:
        float32 (N, M); `NIGHT` everywhere when the sun is not up. Beyond the edge nothing casts a shadow.
    """
    if elevation <= 0:
        return np.full(heights.shape, NIGHT, np.float32)
    result = np.empty(heights.shape, np.float32)
    _sweep(np.asarray(heights, np.float64), cell, azimuth, math.tan(min(elevation, 1.57)), result)
    return result


def land_shadow(terrain: Arrays, sun: tuple[float, float]) -> np.ndarray:
    """Height [m] of the shadow of land and stands for a sun (azimuth, elevation), row 0 at the south as textures have
    it."""
    return np.ascontiguousarray(shadow_height(terrain["surface"], CELL, *sun)[::-1])
