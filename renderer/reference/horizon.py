"""Exact horizons of an elevation grid: the largest elevation angle that the terrain reaches along an azimuth.

The surface is bilinear in each cell, the eye stands on it, the Earth is flat and nothing lies beyond the grid. Along a
ray, the height over one cell is a quadratic of the distance s: the slope (h(s) - h0) / s has its extremes at the ends
of the cell's segment and where s^2 = c0 / c2, so that the maximum is in closed form and no step size enters.
`horizon_rad = atan(sup over s > 0 of (h(s) - h0) / s)`: not clamped at 0.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed

import numpy as np
from numba import njit
from numpy.typing import NDArray

from renderer.core.errors import InputError

Floats = NDArray[np.float64]

TIE = 1e-12
"""Slopes closer than this are equal and the nearer place is reported: rounding must not choose between places."""

CHUNK = 4096
"""Rays between two reports of progress: a few milliseconds of work on grids of some hundred nodes."""


@njit(cache=True, nogil=True)
def _segment(p: float, q: float, c: float, s0: float, s1: float) -> tuple[float, float]:
    """Largest slope over one cell, and where.

    Heights above the eye are p + q t + c t^2 at the distance s0 + t, t in [0, s1 - s0].
    """
    length = s1 - s0
    if s0 <= 0.0:
        # In the eye's own cell p = 0 and the slope is q + c s: its supremum is at the far end or the limit s -> 0.
        return (q + c * s1, s1) if c * s1 > TIE else (q, 0.0)
    best, where = p / s0, s0
    last = (p + (q + c * length) * length) / s1
    if last > best + TIE:
        best, where = last, s1
    if c != 0.0:
        # d/ds of the slope vanishes where s^2 = s0^2 - (q s0 - p) / c
        square = s0 * s0 - (q * s0 - p) / c
        if square > s0 * s0 and square < s1 * s1:
            s = math.sqrt(square)
            t = s - s0
            value = (p + (q + c * t) * t) / s
            if value > best + TIE:
                best, where = value, s
    return best, where


@njit(cache=True, nogil=True)
def _one(z: Floats, row: float, col: float, step_row: float, step_col: float, top: float) -> tuple[float, float]:
    """Slope of the horizon and its distance from (row, col) along (step_row, step_col) grid units a metre."""
    rows, cols = z.shape
    best, where = -math.inf, 0.0
    s, h0, first = 0.0, 0.0, True
    i = min(max(math.floor(row), 0), rows - 2)
    j = min(max(math.floor(col), 0), cols - 2)
    # a ray that starts on a grid line belongs to the cell ahead of it
    if step_row < 0.0 and row == i and i > 0:
        i -= 1
    if step_col < 0.0 and col == j and j > 0:
        j -= 1
    while 0 <= i < rows - 1 and 0 <= j < cols - 1:
        to_row = to_col = math.inf
        if step_row != 0.0:
            to_row = ((i + 1 if step_row > 0.0 else i) - row) / step_row
        if step_col != 0.0:
            to_col = ((j + 1 if step_col > 0.0 else j) - col) / step_col
        end = min(to_row, to_col)
        v, u = row + s * step_row - i, col + s * step_col - j
        a, b, k = z[i, j + 1] - z[i, j], z[i + 1, j] - z[i, j], z[i + 1, j + 1] - z[i, j + 1] - z[i + 1, j] + z[i, j]
        height = z[i, j] + a * u + b * v + k * u * v
        if first:
            h0, first = height, False
        if end > s:
            slope = a * step_col + b * step_row + k * (u * step_row + v * step_col)
            value, at = _segment(height - h0, slope, k * step_row * step_col, s, end)
            if value > best + TIE:
                best, where = value, at
            s = end
            # nothing ahead rises above the grid's top, so no slope ahead exceeds (top - h0) / s
            if (top - h0) <= best * s:
                break
        if to_row <= to_col:
            i += 1 if step_row > 0.0 else -1
        if to_col <= to_row:
            j += 1 if step_col > 0.0 else -1
    return best, where


@njit(cache=True, nogil=True)
def _all(
    z: Floats, points: Floats, steps: Floats, top: float, first: int, last: int, angle: Floats, distance: Floats
) -> None:
    count = steps.shape[0]
    for n in range(first, last):
        p, a = n // count, n % count
        slope, where = _one(z, points[p, 0], points[p, 1], steps[a, 0], steps[a, 1], top)
        angle[p, a] = math.atan(slope)
        distance[p, a] = where


def horizon(
    elevation: NDArray[np.floating],
    cell_size: tuple[float, float],
    points: NDArray[np.floating],
    azimuths: NDArray[np.floating],
    progress: Callable[[float, str], None] | None = None,
) -> tuple[Floats, Floats]:
    """Exact elevation angle of the horizon, and where it is.

    Args:
        elevation: (rows, cols) heights at grid nodes, m, row 0 = northern edge.
        cell_size: (dx, dy), m.
        points: (P, 2) row and column of the eyes, in grid units; they may lie between nodes.
        azimuths: (A,) clockwise from north, rad.
        progress: told the share done; may raise `Cancelled`.

    Returns:
        elevation_rad (P, A), not clamped at 0, and distance_m (P, A) along the horizontal, 0 where the first cell's own
        slope at the eye limits. An eye on the grid's edge that looks outward sees nothing: -pi/2 and 0.

    Raises:
        InputError: a grid of fewer than 2 x 2 nodes or with holes, a point off the grid, or values that are not finite.
    """
    z, eyes, angles = _checked(elevation, cell_size, points, azimuths)
    dx, dy = cell_size
    # pi's rounding leaves 1e-16 in sin and cos: an exact zero keeps rays along a grid line on that line
    sine, cosine = np.sin(angles), np.cos(angles)
    sine[np.abs(sine) < 1e-15] = 0.0
    cosine[np.abs(cosine) < 1e-15] = 0.0
    steps = np.ascontiguousarray(np.stack([-cosine / dy, sine / dx], axis=1))
    shape = (len(eyes), len(angles))
    angle, distance = np.full(shape, -np.pi / 2), np.zeros(shape)
    total, top = shape[0] * shape[1], float(z.max())

    def trace(first: int) -> int:
        last = min(first + CHUNK, total)
        _all(z, eyes, steps, top, first, last, angle, distance)
        return last - first

    done = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        try:
            for traced in as_completed([pool.submit(trace, first) for first in range(0, total, CHUNK)]):
                done += traced.result()
                if progress is not None:
                    progress(done / total, "tracing horizons")
        finally:
            pool.shutdown(cancel_futures=True)
    return angle, distance


def _checked(
    elevation: NDArray[np.floating],
    cell_size: tuple[float, float],
    points: NDArray[np.floating],
    azimuths: NDArray[np.floating],
) -> tuple[Floats, Floats, Floats]:
    """The inputs as float64, or the error that names the wrong one."""
    z = np.ascontiguousarray(elevation, np.float64)
    if z.ndim != 2 or min(z.shape) < 2:
        raise InputError("elevation", f"has shape {z.shape}", "at least 2 x 2 nodes")
    if not np.isfinite(z).all():
        raise InputError("elevation", "has holes or values that are not finite")
    if len(cell_size) != 2 or not all(math.isfinite(size) and size > 0 for size in cell_size):
        raise InputError("cell_size", "must be two positive lengths", "(dx, dy) in metres")
    eyes = np.ascontiguousarray(points, np.float64)
    if eyes.ndim != 2 or eyes.shape[1] != 2:
        raise InputError("points", f"has shape {eyes.shape}", "(P, 2): row, column")
    last = np.array(z.shape) - 1.0
    if not ((eyes >= 0) & (eyes <= last)).all():
        raise InputError("points", "a point lies off the grid", f"rows 0 to {last[0]:g}, columns 0 to {last[1]:g}")
    angles = np.array(azimuths, np.float64)
    if angles.ndim != 1 or not np.isfinite(angles).all():
        raise InputError("azimuths", "must be a list of finite angles")
    return z, eyes, angles
