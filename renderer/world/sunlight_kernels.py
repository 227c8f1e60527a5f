"""Direct sun and visible sky of every node of a surface: the compiled part of a sun study.

A ray climbs over a pyramid of maxima: a block is skipped where even its highest point, at the block's near side, would
not rise above the horizon found so far. The horizon starts at the lowest sun that could be seen along that azimuth and
at the place that was the horizon along the azimuth before, and ends at the highest sun: most rays touch a few cells.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Pyramid = tuple[NDArray[np.float32], NDArray[np.int64], NDArray[np.int64]]

CHANNELS = 4
"""Results of a node: hours of direct sun, beam and sky irradiation, share of the sky."""


def pyramid(surface: NDArray[np.floating]) -> Pyramid:
    """Highest points of all cells, of blocks of 2 x 2 cells, of 4 x 4, and so on up to one block.

    Args:
        surface: (rows, columns) heights at the nodes, m.

    Returns:
        all levels in one array, where each begins, and how many blocks wide each is.
    """
    nodes = np.asarray(surface, np.float32)
    level = np.maximum(
        np.maximum(nodes[:-1, :-1], nodes[:-1, 1:]),
        np.maximum(nodes[1:, :-1], nodes[1:, 1:]),
    )
    levels = [level]
    while max(level.shape) > 1:
        padding = ((0, level.shape[0] % 2), (0, level.shape[1] % 2))
        level = np.pad(level, padding, constant_values=-np.inf)
        blocks = level.reshape(level.shape[0] // 2, 2, level.shape[1] // 2, 2)
        level = blocks.max(axis=(1, 3))
        levels.append(level)
    starts = np.cumsum([0, *(part.size for part in levels[:-1])]).astype(np.int64)
    widths = np.array([part.shape[1] for part in levels], np.int64)
    return np.concatenate([part.ravel() for part in levels]), starts, widths


@njit(cache=True, nogil=True)
def _between(one, other, part):
    return one * (1.0 - part) + other * part


@njit(cache=True, nogil=True)
def _height(surface, row, column):
    """Height of the bilinear surface at a point inside the grid."""
    i, j = min(int(row), surface.shape[0] - 2), min(int(column), surface.shape[1] - 2)
    v, u = row - i, column - j
    north = _between(surface[i, j], surface[i, j + 1], u)
    south = _between(surface[i + 1, j], surface[i + 1, j + 1], u)
    return _between(north, south, v)


@njit(cache=True, nogil=True, error_model="numpy")
def _start(surface, row, column, i, j, down, right, low, guess):
    """Horizon before the walk: at least `low`, the node's own slope, and what stands at the distance guessed."""
    eye = float(surface[row, column])
    best = low
    across = float(surface[row, j + 1]) - float(surface[row, j])
    along = float(surface[i + 1, column]) - float(surface[i, column])
    own = across * right + along * down
    if own > best:
        best = own
    if guess > 0.0:
        y, x = row + guess * down, column + guess * right
        if y >= 0.0 and y <= surface.shape[0] - 1 and x >= 0.0 and x <= surface.shape[1] - 1:
            best = max(best, (_height(surface, y, x) - eye) / guess)
    return best


@njit(cache=True, nogil=True)
def _onward(cell, reached, forward):
    """The cell that a ray reached along an axis: never one that it left, which rounding would lead it back to."""
    return max(cell, reached) if forward > 0.0 else min(cell, reached)


@njit(cache=True, nogil=True, error_model="numpy")
def _horizon(surface, tops, starts, widths, row, column, down, right, low, high, guess):
    """Slope of the horizon from a node, where it lies between `low` and `high`.

    The surface is read where the ray crosses the grid's lines, on which a bilinear cell is linear; inside a cell it
    bulges by less than a quarter of its twist.

    Args:
        surface: (rows, columns) m. tops, starts, widths: its pyramid.
        row, column: the node. down, right: grid units a metre along the ray. low, high: slopes below and above which
            the answer does not matter. guess: a distance at which the horizon may be [m], 0 for none.

    Returns:
        the slope, at least `low`; the distance where it was met [m], or `guess`.
    """
    rows, columns = surface.shape
    i = row if (down > 0.0 or (down == 0.0 and row < rows - 1)) else row - 1
    j = column if (right > 0.0 or (right == 0.0 and column < columns - 1)) else column - 1
    if i < 0 or j < 0 or i >= rows - 1 or j >= columns - 1:
        return low, guess
    eye = float(surface[row, column])
    best, where = _start(surface, row, column, i, j, down, right, low, guess), guess
    last = len(widths) - 1
    highest = tops[starts[last]] - eye
    next_row, next_column = int(down > 0.0), int(right > 0.0)
    a_row, a_column = 1.0 / down, 1.0 / right  # metres; unused where the ray keeps its row or its column
    distance, level = 0.0, 0
    while best < high and highest > best * distance:
        block_row, block_column = i >> level, j >> level
        rise = tops[starts[level] + block_row * widths[level] + block_column] - eye
        hides = rise > best * distance
        if hides and level > 0:
            level -= 1
            continue
        line_row = min((block_row + next_row) << level, rows - 1)
        line_column = min((block_column + next_column) << level, columns - 1)
        to_row = (line_row - row) * a_row if down != 0.0 else math.inf
        to_column = (line_column - column) * a_column if right != 0.0 else math.inf
        distance = min(to_row, to_column)
        if hides:
            if to_row <= to_column:
                met = _between(surface[line_row, j], surface[line_row, j + 1], column + distance * right - j)
            else:
                met = _between(surface[i, line_column], surface[i + 1, line_column], row + distance * down - i)
            slope = (met - eye) / distance
            if slope > best:
                best, where = slope, distance
        if to_row <= to_column:
            i = line_row if down > 0.0 else line_row - 1
        elif level > 0:
            i = _onward(i, int(row + distance * down), down)
        if to_column <= to_row:
            j = line_column if right > 0.0 else line_column - 1
        elif level > 0:
            j = _onward(j, int(column + distance * right), right)
        if i < 0 or j < 0 or i >= rows - 1 or j >= columns - 1:
            break
        # A wider view pays once the ray leaves its parent block.
        if level < last and ((i >> (level + 1)) != (block_row >> 1) or (j >> (level + 1)) != (block_column >> 1)):
            level += 1
    return best, where


@njit(cache=True, nogil=True)
def _first_above(tangents, first, last, slope):
    """Place of the first of the rising `tangents` [first, last) above a slope; `last` where none is."""
    while first < last:
        middle = (first + last) // 2
        if tangents[middle] > slope:
            last = middle
        else:
            first = middle + 1
    return first


@njit(cache=True, nogil=True, error_model="numpy")
def light(surface, levels, nodes, normals, share, steps, firsts, tangents, sums, directions, diffuse, result):
    """Hours, irradiation and visible sky of some nodes.

    Args:
        surface: (rows, columns) float32 heights [m]. levels: its pyramid.
        nodes: (N, 2) int64 row and column. normals: (N, 3) of the receiver. share: (N,) place of the node's height
            between the two altitudes of the light, [0, 1].
        steps: (B, 2) grid units a metre along the azimuth of each bin. firsts: (B + 1,) the first sun of each.
        tangents: (S,) of the suns' elevations, rising within a bin.
        sums: (S + B, 7) of the suns of a bin from each on: hours, and beam times direction [kWh m-2] at both altitudes.
        directions: (D, 4) sky azimuths: grid units a metre, then east and north.
        diffuse: (2,) irradiation of a level plane by the whole sky at both altitudes [kWh m-2].
        result: (N, 4) float32: hours [h], beam, diffuse [kWh m-2], share of the sky.
    """
    tops, starts, widths = levels
    for n in range(len(nodes)):
        row, column = nodes[n]
        upper, lower = share[n], 1.0 - share[n]
        x, y, z = normals[n, 0], normals[n, 1], normals[n, 2]
        hours, beam, guess = 0.0, 0.0, 0.0
        for b in range(len(steps)):
            first, last = firsts[b], firsts[b + 1]
            low, high = tangents[first] * (1.0 - 1e-12), tangents[last - 1]
            slope, guess = _horizon(
                surface, tops, starts, widths, row, column, steps[b, 0], steps[b, 1], low, high, guess
            )
            sums_of = sums[_first_above(tangents, first, last, slope) + b]
            hours += sums_of[0]
            east = lower * sums_of[1] + upper * sums_of[4]
            north = lower * sums_of[2] + upper * sums_of[5]
            up = lower * sums_of[3] + upper * sums_of[6]
            beam += max(0.0, x * east + y * north + z * up)
        sky, guess = 0.0, 0.0
        for d in range(len(directions)):
            down, right = directions[d, 0], directions[d, 1]
            towards = x * directions[d, 2] + y * directions[d, 3]
            # No light comes from behind the receiver's own plane, which the surface's cells leave by a little.
            low = max(0.0, -towards / z)
            slope, guess = _horizon(surface, tops, starts, widths, row, column, down, right, low, math.inf, guess)
            sky += sky_of(slope, z, towards)
        sky /= len(directions)
        result[n, 0], result[n, 1] = hours, beam
        result[n, 2], result[n, 3] = sky * (lower * diffuse[0] + upper * diffuse[1]), sky


@njit(cache=True, nogil=True)
def sky_of(slope, up, towards):
    """Share of an even sky's irradiance that one azimuth sends above its horizon (Dozier and Frew 1990, eq. 7b).

    Args:
        slope: of the horizon. up: the normal's vertical part. towards: its part towards the azimuth.
    """
    elevation = math.atan(slope)
    square = 1.0 / (1.0 + slope * slope)
    return up * square + towards * (0.5 * math.pi - elevation - slope * square)
