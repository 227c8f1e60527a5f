"""Terrain horizons over the whole square, by exact hull sweeps along every azimuth."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numba import njit

from renderer.core.technique import Arrays
from renderer.forest.world_scale import CELL

AZIMUTHS = 128
"""Directions swept; each sector takes those inside it and on its two borders."""


@njit(cache=True, nogil=True)
def _sweep(heights, cell, azimuth, slopes):
    """Slope of the horizon at every node, looking along one azimuth; 0 where nothing rises above the node.

    Lines run along the azimuth, one for each row or column they start from; walking against the azimuth, the hull of
    what was passed stays on a stack whose top is the horizon. A node between two lines takes the mean of both,
    weighted by nearness.

    Args:
        heights: (N, M) [m], row 0 the northern edge. cell: side of a cell [m]. azimuth: [rad], clockwise from north.
        slopes: (N, M) float32, result.

    Source: Dozier, Bruno & Downey 1981; Timonen & Westerholm 2010 (hull on a stack); formulas i.
    """
    east, south = math.sin(azimuth), -math.cos(azimuth)
    along_rows = abs(south) >= abs(east)
    grid = heights if along_rows else heights.T
    result = slopes if along_rows else slopes.T
    major, minor = (south, east) if along_rows else (east, south)
    length, width = grid.shape
    drift = minor / abs(major)
    step = cell / abs(major)
    forward = major > 0
    extent = math.ceil(abs(drift) * (length - 1)) + 1
    distance, height = np.empty(length), np.empty(length)
    result[:] = np.float32(0.0)
    for line in range(-extent, width + extent):
        size = 0
        for walked in range(length):
            # Walking against the azimuth: from the far end of the line towards its start.
            row = length - 1 - walked if forward else walked
            place = line + drift * (length - 1 - walked)
            low = math.floor(place)
            if low < -1 or low >= width:
                continue
            share = place - low
            if low < 0:
                here = grid[row, 0]
            elif low + 1 >= width:
                here = grid[row, width - 1]
            else:
                here = (1 - share) * grid[row, low] + share * grid[row, low + 1]
            at = -walked * step
            while size >= 2 and (height[size - 2] - here) * (distance[size - 1] - at) >= (height[size - 1] - here) * (
                distance[size - 2] - at
            ):
                size -= 1
            if size > 0:
                slope = (height[size - 1] - here) / (distance[size - 1] - at)
                if slope > 0:
                    if low >= 0:
                        result[row, low] += np.float32((1 - share) * slope)
                    if low + 1 < width:
                        result[row, low + 1] += np.float32(share * slope)
            distance[size], height[size] = at, here
            size += 1


def sweep(heights: np.ndarray, cell: float, azimuth: float) -> np.ndarray:
    """Elevation of the horizon [rad] at every node along one azimuth.

    Args:
        heights: (N, M) [m], row 0 the northern edge. cell: side of a cell [m]. azimuth: [rad], clockwise from north.

    Returns:
        float32 (N, M), at least 0: beyond the edge, and where nothing rises, an infinite plane continues the land.
    """
    slopes = np.zeros(heights.shape, np.float32)
    _sweep(np.ascontiguousarray(heights, np.float64), cell, azimuth, slopes)
    return np.arctan(slopes)


def sector_range(sector: int, sectors: int, azimuths: int) -> np.ndarray:
    """Numbers of the azimuths inside a sector or on its borders; sector k's axis is azimuth k * azimuths /
    sectors."""
    half = azimuths // sectors // 2
    middle = sector * azimuths // sectors
    return np.arange(middle - half, middle + half + 1) % azimuths


def bake_terrain_horizon(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """Smallest elevation above which every direction of a sector is clear of the land and its stands.

    The sweep runs over the stands' tops: between two wooded points that is the terrain's own horizon, and a glade sees
    the forest's edge around it, which the canopy's own horizon over the tile cannot know.

    Args:
        arguments: `sectors`, 4 to 32. inputs: `terrain`, with `surface` (N, N) [m].

    Returns:
        `sectors` float32 [chi, N, N] [rad], at least 0, from the horizontal; sector k is centred at azimuth 2 pi k /
        chi from north.

    Source: Cohen 2004, section 3.1, phi_min; formulas i for the sweep in place of his cube maps.
    """
    heights = np.ascontiguousarray(inputs["terrain"]["surface"], np.float64)
    sectors = int(arguments["sectors"])
    result = np.zeros((sectors, *heights.shape), np.float32)
    owners: list[list[int]] = [[] for _ in range(AZIMUTHS)]
    for sector in range(sectors):
        for number in sector_range(sector, sectors, AZIMUTHS):
            owners[number].append(sector)

    def one(number: int) -> tuple[int, np.ndarray]:
        slopes = np.zeros(heights.shape, np.float32)
        _sweep(heights, CELL, 2 * math.pi * number / AZIMUTHS, slopes)
        return number, slopes

    with ThreadPoolExecutor(2) as pool:
        for done, (number, slopes) in enumerate(pool.map(one, range(AZIMUTHS))):
            progress(done / AZIMUTHS, "sweeping the horizon")
            for sector in owners[number]:
                np.maximum(result[sector], slopes, out=result[sector])
    return {"sectors": np.arctan(result, out=result)}
