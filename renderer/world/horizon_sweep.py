"""Horizons of a whole height field along one azimuth, in time proportional to the number of nodes.

The ray from a node is cut in two. **Near**, over its first rows (or columns, whichever it crosses faster): every
crossing with a grid line is a sample of the bilinear surface, and the slope at the node itself is another. **Far**,
beyond them: parallel lines run along the azimuth, one for each row or column they start from, and what a line has
passed lies in a hull on a stack, whose top is the horizon.

Exact are, near, the samples; and far, each line's tangent, which equals a search over all samples of that line. Not
exact: the mean of two lines stands for the line between them, and far samples lie on rows only.

Source: Dozier, Bruno & Downey 1981; Timonen & Westerholm 2010 (hull on a stack); formulas i. The near part and the
stack that lags behind it are additions: on a line half a cell away the nearest samples are others.
"""

from __future__ import annotations

import math
import os
from collections import deque
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np
from numba import njit
from numpy.typing import NDArray

from renderer.core.errors import InputError

Slopes = NDArray[np.float32]

NEAR = 8
"""Rows sampled from the node itself: without them the mean error is ten to forty times as large; eight cost a tenth
more time than none."""

NOTHING = 1e30
"""Slope, downward, of a line that sees nothing, until a node's shares are summed."""


@njit(cache=True, nogil=True)
def _far(grid, step, drift, near, slopes):
    """Add what the lines see beyond `near` rows to the nodes on either side of each.

    A vertex that an eye looks past on its stack is popped by one of the next `near + 1` samples pushed, for they stand
    above it from there: all walks together cost as much as all pops.

    Args:
        grid: (width, length) [m]; the azimuth goes up along the last axis, and sideways up by `drift` nodes a row, 0 to
        1. step: metres of the line from row to row. slopes: result, float32, of the grid's shape.
    """
    width, length = grid.shape
    at, height, line = np.empty(length), np.empty(length), np.empty(length)
    for start in range(-math.ceil(drift * (length - 1)), width):
        size, pushed = 0, length
        # Against the azimuth: from the far end of the line towards its start.
        for m in range(length - 1, -1, -1):
            place = start + drift * m
            if place > width - 1:
                continue
            if place < 0:
                break
            pushed = m if pushed == length else pushed
            low = min(math.floor(place), width - 2)
            share = place - low
            left, right = grid[low, m], grid[low + 1, m]
            here = left + share * (right - left)
            line[m] = here
            if pushed > m + near:
                new = line[pushed]
                while size >= 2 and (height[size - 2] - new) * (at[size - 1] - pushed) >= (height[size - 1] - new) * (
                    at[size - 2] - pushed
                ):
                    size -= 1
                at[size], height[size] = pushed, new
                size, pushed = size + 1, pushed - 1
            if size == 0:
                on_left = on_right = -NOTHING
            else:
                top = size - 1
                while top >= 1 and (height[top - 1] - here) * (at[top] - m) >= (height[top] - here) * (at[top - 1] - m):
                    top -= 1
                # On a curved ground the mean of both lines' eyes stands off the node between them, by a share of this.
                before = grid[low - 1, m] if low > 0 else 2.0 * left - right
                after = grid[low + 2, m] if low + 2 < width else 2.0 * right - left
                bent = share * (1.0 - share)
                rise, per_metre = height[top] - here, 1.0 / ((at[top] - m) * step)
                on_left = (rise + bent * (before - 2.0 * left + right)) * per_metre
                on_right = (rise + bent * (left - 2.0 * right + after)) * per_metre
            # A node on the grid's side has a line on one side only.
            to_left = 1.0 if place < 1.0 else 1.0 - share
            to_right = 1.0 if place > width - 2 else share
            slopes[low, m] += np.float32(to_left * on_left)
            slopes[low + 1, m] += np.float32(to_right * on_right)


@njit(cache=True, nogil=True)
def _raise(eye, first, second, share, distance, count, slopes):
    """Raise `count` slopes to those of a sample between two rows of nodes, `distance` metres from each eye."""
    per_metre = 1.0 / distance
    for m in range(count):
        seen = np.float32((first[m] * (1.0 - share) + second[m] * share - eye[m]) * per_metre)
        slopes[m] = seen if seen > slopes[m] else slopes[m]


@njit(cache=True, nogil=True)
def _near(grid, step, drift, near, slopes):
    """Raise slopes to those of the ray's crossings with the grid's lines in its first rows, and of the first cell.

    Args: as `_far`.
    """
    width, length = grid.shape
    for c in range(width):
        eye, mine = grid[c], slopes[c]
        for k in range(1, min(near, length - 1) + 1):
            place = c + drift * k
            if place > width - 1:
                break
            low = min(math.floor(place), width - 2)
            _raise(eye, grid[low, k:], grid[low + 1, k:], place - low, k * step, length - k, mine)
        if drift == 0.0 or near == 0:
            continue
        for j in range(1, min(math.floor(near * drift), width - 1 - c) + 1):
            rows = j / drift
            low = math.floor(rows)
            if low + 1 < length:
                beside = grid[c + j, low:]
                _raise(eye, beside, beside[1:], rows - low, rows * step, length - low - 1, mine)
        if c + 1 < width:
            beside = grid[c + 1]
            for m in range(length - 1):
                seen = np.float32((eye[m + 1] - eye[m] + drift * (beside[m] - eye[m])) / step)
                mine[m] = seen if seen > mine[m] else mine[m]


def sweep(heights: NDArray[np.floating], cell_size: tuple[float, float], azimuth: float, near: int = NEAR) -> Slopes:
    """Slope of the horizon at every node, looking along one azimuth.

    Args:
        heights: (rows, columns) [m], row 0 the northern edge. cell_size: (dx, dy) [m].
        azimuth: clockwise from north [rad].
        near: rows of each ray that are sampled from the node itself; 0 leaves all to the lines.

    Returns:
        float32 (rows, columns): the largest rise over run, below 0 where the land falls away, minus infinity where the
        grid ends at the node. Its arctangent is the elevation of the horizon.

    Raises:
        InputError: a grid of fewer than 2 x 2 nodes, or sizes that are not positive.
    """
    if heights.ndim != 2 or min(heights.shape) < 2:
        raise InputError("elevation", f"has shape {heights.shape}", "at least 2 x 2 nodes")
    if not all(math.isfinite(size) and size > 0 for size in cell_size):
        raise InputError("cell_size", "must be two positive lengths", "(dx, dy) in metres")
    south, east = -math.cos(azimuth) / cell_size[1], math.sin(azimuth) / cell_size[0]
    by_rows = abs(south) >= abs(east)
    along, across = (south, east) if by_rows else (east, south)
    # pi's rounding leaves 1e-16 in sine and cosine: a line along the grid stays on its nodes.
    drift = abs(across / along) if abs(across / along) > 1e-12 else 0.0
    turned = np.s_[:: 1 if across >= 0 else -1, :: 1 if along >= 0 else -1]
    grid = np.ascontiguousarray((heights.T if by_rows else heights)[turned], np.float64)
    slopes = np.zeros(grid.shape, np.float32)
    _far(grid, 1 / abs(along), drift, near, slopes)
    _near(grid, 1 / abs(along), drift, near, slopes)
    slopes[slopes < -1e9] = -np.inf
    found = slopes[turned]
    return np.ascontiguousarray(found.T if by_rows else found)


def sweeps(
    heights: NDArray[np.floating],
    cell_size: tuple[float, float],
    azimuths: Sequence[float],
    threads: int | None = None,
    near: int = NEAR,
) -> Iterator[tuple[int, Slopes]]:
    """The sweep along each azimuth, in their order, on all cores; few are held at once.

    Args:
        heights, cell_size, near: as for `sweep`. azimuths: [rad]. threads: one a core when left out.

    Yields:
        The azimuth's number and its slopes.
    """
    threads = threads or os.cpu_count() or 1
    with ThreadPoolExecutor(threads) as pool:
        waiting: deque[tuple[int, Future[Slopes]]] = deque()
        for number, azimuth in enumerate(azimuths):
            waiting.append((number, pool.submit(sweep, heights, cell_size, azimuth, near)))
            if len(waiting) > threads:
                first, future = waiting.popleft()
                yield first, future.result()
        for first, future in waiting:
            yield first, future.result()
