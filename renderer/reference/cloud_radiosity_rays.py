"""Rays between a bilinear relief and a level base at height 1, marched cell by cell, for the truth of bounced light."""

from __future__ import annotations

import math

import numpy as np
from numba import njit, prange

LIFT = 1e-7
"""How far above its own surface a ray starts, so that rounding does not let it meet it."""


@njit(cache=True, inline="always")
def _height(z, x, y):
    """Bilinear height at a place in cell units, within the grid."""
    n = z.shape[0] - 1
    i, j = min(max(int(y), 0), n - 1), min(max(int(x), 0), n - 1)
    u, v = x - j, y - i
    return (z[i, j] * (1 - u) + z[i, j + 1] * u) * (1 - v) + (z[i + 1, j] * (1 - u) + z[i + 1, j + 1] * u) * v


@njit(cache=True)
def _meets(z, cell, top, x, y, h, dx, dy, dz):
    """Where a ray from (x, y, h) meets the relief: its cell's number, or -1 where it leaves the square or passes `top`.

    x and y in cells, h in heights of the base; (dx, dy, dz) a unit direction in heights.
    """
    n = z.shape[0] - 1
    dx, dy = dx / cell, dy / cell
    t = 0.0
    if dz < 0.0 and h > top:
        t = (h - top) / -dz
    elif dz >= 0.0 and h > top:
        return -1
    while True:
        px, py = x + t * dx, y + t * dy
        # The cell that the ray is about to cross, by its direction where it stands on an edge.
        j = math.floor(px + 1e-9 * (1.0 if dx > 0 else -1.0))
        i = math.floor(py + 1e-9 * (1.0 if dy > 0 else -1.0))
        if i < 0 or j < 0 or i >= n or j >= n:
            return -1
        end = 1e30
        if dx > 1e-15:
            end = min(end, (j + 1 - x) / dx)
        elif dx < -1e-15:
            end = min(end, (j - x) / dx)
        if dy > 1e-15:
            end = min(end, (i + 1 - y) / dy)
        elif dy < -1e-15:
            end = min(end, (i - y) / dy)
        if end > 1e29:
            end = t + 2.0 / max(abs(dz), 1e-9)
        end = max(end, t)
        # The gap above the bilinear cell is a quadratic of the way: three values tell it.
        middle = 0.5 * (t + end)
        g0 = h + t * dz - _height(z, px, py)
        g1 = h + middle * dz - _height(z, x + middle * dx, y + middle * dy)
        g2 = h + end * dz - _height(z, x + end * dx, y + end * dy)
        low = min(g0, g1, g2)
        curve = 2.0 * (g0 - 2.0 * g1 + g2)
        if curve > 0.0:
            at = (3.0 * g0 - 4.0 * g1 + g2) / (2.0 * curve)
            if 0.0 < at < 1.0:
                low = min(low, g0 - 0.5 * curve * at * at)
        if low < 0.0:
            return i * n + j
        if dz >= 0.0 and h + end * dz > top:
            return -1
        t = end


@njit(cache=True, parallel=True)
def cast(z, half, rays, turns):
    """What every ray of every point meets.

    Args:
        z: heights of the nodes, (N + 1, N + 1). half: of the square's side. rays: a point.
        turns: random turn of each point's rays, (2, N, N, 2), for ground and base.

    Returns:
        (2, N, N, rays) uint16: number of the ground's cell, N^2 + that of the base's, or 2 N^2 for none.
    """
    n = z.shape[0] - 1
    cell = 2 * half / n
    top = z.max()
    hits = np.empty((2, n, n, rays), np.uint16)
    for i in prange(n):
        for j in range(n):
            x, y = j + 0.5, i + 0.5
            h = _height(z, x, y)
            gx = (z[i, j + 1] + z[i + 1, j + 1] - z[i, j] - z[i + 1, j]) / (2 * cell)
            gy = (z[i + 1, j] + z[i + 1, j + 1] - z[i, j] - z[i, j + 1]) / (2 * cell)
            length = math.sqrt(1 + gx * gx + gy * gy)
            for k in range(rays):
                # Additive recurrence on the square (Roberts 2018), each point's own turn.
                a = (turns[0, i, j, 0] + k * 0.7548776662466927) % 1.0
                b = (turns[0, i, j, 1] + k * 0.5698402909980532) % 1.0
                hits[0, i, j, k] = _upward(z, cell, top, n, x, y, h, gx, gy, length, a, b)
                a = (turns[1, i, j, 0] + k * 0.7548776662466927) % 1.0
                b = (turns[1, i, j, 1] + k * 0.5698402909980532) % 1.0
                sine, angle = math.sqrt(a), 2 * math.pi * b
                down = -math.sqrt(max(1 - a, 1e-12))
                met = _meets(z, cell, top, x, y, 1.0, sine * math.cos(angle), sine * math.sin(angle), down)
                hits[1, i, j, k] = 2 * n * n if met < 0 else met
    return hits


@njit(cache=True)
def _upward(z, cell, top, n, x, y, h, gx, gy, length, a, b):
    """What a ray of a ground point meets, drawn by the cosine to its normal (-gx, -gy, 1) / length."""
    sine, angle = math.sqrt(a), 2 * math.pi * b
    u, v, w = sine * math.cos(angle), sine * math.sin(angle), math.sqrt(max(1 - a, 1e-12))
    nx, ny, nz = -gx / length, -gy / length, 1 / length
    # An orthonormal frame around the normal, which always looks up (Duff et al. 2017).
    p = -1.0 / (1.0 + nz)
    q = nx * ny * p
    dx = u * (1 + nx * nx * p) + v * q + w * nx
    dy = u * q + v * (1 + ny * ny * p) + w * ny
    dz = -u * nx - v * ny + w * nz
    met = _meets(z, cell, top, x, y, h + LIFT, dx, dy, dz)
    if met >= 0:
        return met
    if dz <= 1e-9:
        return 2 * n * n
    t = (1.0 - h) / dz
    j, i = math.floor(x + t * dx / cell), math.floor(y + t * dy / cell)
    if i < 0 or j < 0 or i >= n or j >= n:
        return 2 * n * n
    return n * n + i * n + j


@njit(cache=True, parallel=True)
def gather(hits, light):
    """Mean light of what each point's rays meet, (2, N, N), of the light of ground cells, base cells and nothing."""
    sides, n, m, rays = hits.shape
    found = np.empty((sides, n, m))
    for i in prange(n):
        for side in range(sides):
            for j in range(m):
                total = 0.0
                for k in range(rays):
                    total += light[hits[side, i, j, k]]
                found[side, i, j] = total / rays
    return found
