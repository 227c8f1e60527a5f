"""How high the shadow of land and stands reaches over every node for one sun."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit
from scipy.ndimage import maximum_filter

from renderer.core.technique import Arrays, Bake
from renderer.forest.pattern import tallest
from renderer.forest.world_scale import CELL, NODES, PRESENCE_CELL

NIGHT = 1e6
"""Height [m] of the shadow when the sun is not up."""

FLOOR = 30.0
"""Depth [m] under the ground below which no ray is followed."""

LOWEST, MEAN, HIGHEST = -1, 0, 1
"""What a node takes of the two lines beside it: the lower one, a mean weighted by nearness, or the higher one."""

LINES = 4
"""Lines a cell where the shadow itself is wanted, not bounds of it: where a ridge ends, it jumps from line to line."""

FOOT_REACH = 8.0
"""Longest way [m] along either axis from a tree's foot to what it owns."""


@njit(cache=True, nogil=True)
def _carry_in(edge, drift, fall, density, extent, high):
    """Fill `high` with the highest ray that lines bring to the row before the first: beyond it, land goes on as `edge`.

    Moving along the edge by one line, a ray has come over 1 / (density |drift|) rows.
    """
    count, width = len(high), len(edge)
    along = fall / max(density * abs(drift), 1e-9)
    carried = np.empty_like(high)
    for number in range(count):
        line = number if drift > 0.0 else count - 1 - number
        place = min(max(line / density - extent, 0.0), width - 1.0)
        low = min(int(place), width - 2)
        here = edge[low] + (place - low) * (edge[low + 1] - edge[low])
        before = -1e9 if number == 0 else carried[line - 1 if drift > 0.0 else line + 1] - along
        carried[line] = max(here, before)
    for line in range(count):
        place = min(max(line - drift * density, 0.0), count - 1.0)
        low = min(int(place), count - 2)
        high[line] = carried[low] + (place - low) * (carried[low + 1] - carried[low])


@njit(cache=True, nogil=True)
def _sweep(grid, major, minor, fall, density, choice, result):
    """Height of the shadow's upper side, walking away from the sun along lines of its azimuth.

    Lines run along the azimuth, some for each column they start from, and carry the highest ray so far down with them;
    a node takes what the two lines beside it have. Nothing is interpolated twice. Beyond its edge the land goes on as
    it is there.

    Args:
        grid: (N, M) [m], float32. major, minor: of the unit vector to the sun, along the rows' axis and the columns'.
        fall: of a ray from row to row [m]. density: lines a cell. choice: LOWEST, MEAN or HIGHEST.
        result: (N, M) float32.

    Source: Dozier, Bruno & Downey 1981 (lines along the azimuth); one elevation needs no hull, only the highest ray.
    """
    length, width = grid.shape
    drift = -minor / abs(major)
    extent = math.ceil(abs(drift) * (length - 1)) + 1
    high = np.full((width + 2 * extent) * density, np.float32(-1e9))
    through = np.full_like(high, np.float32(-1e9))
    fall, floor, each = np.float32(fall), np.float32(FLOOR), np.float32(1.0 / density)
    _carry_in(grid[length - 1 if major > 0 else 0], drift, fall, density, extent, high)
    for walked in range(length):
        row = length - 1 - walked if major > 0 else walked
        start = (extent - drift * walked) * density  # the line, broken, that passes node 0 of this row
        entering = drift * (length - 1 - walked) * density  # how far beside the grid lines still come in from
        first = max(math.floor(start - max(entering, 0.0)), 0)
        last = min(math.ceil(start + (width - 1) * density - min(entering, 0.0)), len(high) - 1)
        heights, out, begin = grid[row], result[row], np.float32(start - first)
        lines, passing = high[first : last + 1], through[first : last + 1]
        for line in range(last + 1 - first):
            place = min(max((np.float32(line) - begin) * each, np.float32(0.0)), np.float32(width - 1))
            low = min(np.int32(place), np.int32(width - 2))
            here = heights[low] + (place - np.float32(low)) * (heights[low + 1] - heights[low])
            # Without the node itself, for this falls evenly to where it meets the ground between two nodes.
            passing[line] = max(lines[line] - fall, here - floor)
            lines[line] = max(passing[line], here)
        near = np.int32(min(int(begin), last - first - 1))
        share = begin - np.float32(near)
        for node in range(width):
            one, other = passing[node * density + near], passing[min(node * density + near + 1, last - first)]
            mean = one + share * (other - one)
            out[node] = mean if choice == MEAN else max(one, other) if choice == HIGHEST else min(one, other)


def shadow_height(heights: np.ndarray, cell: float, azimuth: float, elevation: float, choice: int = MEAN) -> np.ndarray:
    """Height [m] below which the sun is hidden, at every node, by others than itself.

    Args:
        heights: (N, M) [m], row 0 the northern edge. cell: side of a cell [m].
        azimuth, elevation: of the sun [rad], clockwise from north, from the horizontal.
        choice: MEAN for the height itself; LOWEST or HIGHEST for a bound of it, which costs less.

    Returns:
        float32 (N, M); `NIGHT` everywhere when the sun is not up. Beyond its edge the land goes on as it is there.
    """
    if elevation <= 0:
        return np.full(heights.shape, NIGHT, np.float32)
    density = LINES if choice == MEAN else 1
    tangent = math.tan(min(elevation, 1.57))
    east, south = math.sin(azimuth), -math.cos(azimuth)
    along_rows = abs(south) >= abs(east)
    major, minor = (south, east) if along_rows else (east, south)
    grid = np.ascontiguousarray(heights if along_rows else heights.T, np.float32)
    result = np.empty_like(grid)
    _sweep(grid, major, minor, cell / abs(major) * tangent, density, choice, result)
    return result if along_rows else np.ascontiguousarray(result.T)


def land_shadow(terrain: Arrays, sun: tuple[float, float]) -> np.ndarray:
    """Height [m] of the shadow of land and stands for a sun (azimuth, elevation), row 0 at the south as textures have
    it."""
    return np.ascontiguousarray(shadow_height(terrain["surface"], CELL, *sun)[::-1])


def stand_tops_bake(terrain: Bake, pattern: Bake) -> Bake:
    """What no tree stands above."""
    return Bake("stand_tops", bake_stand_tops, {}, (terrain, pattern), seconds=0.1)


def bake_stand_tops(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """Height that nothing which stands passes, at every node.

    Args:
        inputs: `terrain` and `pattern`.

    Returns:
        `tops` float32 (N, N) [m]: the land itself where no tree stands near enough to lean in.
    """
    progress(0.1, "measuring the stands")
    terrain = inputs["terrain"]
    places = len(terrain["presence"]) // NODES
    # A node's cells reach one cell beyond it, a tree beyond its foot.
    near = 2 * math.ceil((FOOT_REACH + CELL) / PRESENCE_CELL) + 3
    stands = maximum_filter(terrain["presence"], near, mode="nearest")[places // 2 :: places, places // 2 :: places]
    height = tallest(inputs["pattern"]["colour"]) * maximum_filter(terrain["growth"], 3, mode="nearest")
    return {"tops": (terrain["elevation"] + height * (stands > 0)).astype(np.float32)}


def shadow_bounds(terrain: Arrays, tops: np.ndarray, sun: tuple[float, float]) -> np.ndarray:
    """Heights [m] below which the land alone hides the sun, and above which nothing does: (N, N, 2), row 0 at the
    south."""
    sure = shadow_height(terrain["elevation"], CELL, *sun, choice=LOWEST)
    free = shadow_height(tops, CELL, *sun, choice=HIGHEST)
    return np.ascontiguousarray(np.stack([sure, free], axis=-1)[::-1])
