"""The march: where a ray meets matter, in what amount, and where it meets the ground.

Terrain cells are crossed exactly: over a bilinear cell the height of a ray above the ground is a quadratic, whose roots
bound the parts within the canopy and give the hit on the ground in closed form. Within those parts, extinction is
integrated by the midpoint rule; steps that skip are proven empty by the chessboard distance of the atlas.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from renderer.reference.forest_lookup import alpha_at, extinction, foot, lattice, plane, rhombus, stands
from renderer.reference.forest_world import BLOCK, NOWHERE, TILES

LEFT, GROUND, OPAQUE, FULL = 0, 1, 2, 3
"""How a march ended: it left the world, met the ground, ran out of light, or filled its record."""

ALL, NOT_OWN, ONLY_OWN, NONE = (np.int64(mode) for mode in range(4))
"""Which trees a ray meets: every one, all but its own, its own alone, or none.

Numpy's integers, as `SOLID` and counters that start at `ZERO`: for a literal of Python the march, the largest function
here, would be compiled once more.
"""

SOLID = np.bool_(True)
"""The ground stops a ray."""

ZERO = np.int64(0)

S, DS, SIGMA, TU, TV, TK = range(6)
"""Columns of the record: distance of the midpoint (m), step (m), extinction (1/m), texel coordinates."""

COLUMNS = 6
NUDGE = 1e-6
"""Metres by which a ray is looked at beyond a border, to know the cell it enters."""

SAME_FOOT = 0.5
"""Feet nearer than this, m, are one tree: stored offsets are exact to 1/32 m, and trees stand metres apart."""


@njit(cache=True, nogil=True)
def _roots(a: float, b: float, c: float) -> tuple[float, float]:
    """Roots of a t^2 + b t + c in rising order, infinite where there is none; stable where a is nearly 0."""
    if abs(a) < 1e-14:
        if b == 0.0:
            return math.inf, math.inf
        return -c / b, math.inf
    square = b * b - 4.0 * a * c
    if square < 0.0:
        return math.inf, math.inf
    half = -0.5 * (b + math.copysign(math.sqrt(square), b))
    first = half / a
    second = c / half if half != 0.0 else first
    return min(first, second), max(first, second)


@njit(cache=True, nogil=True)
def _exit(start: float, step: float, low: float, high: float) -> float:
    """Distance at which start + s step leaves [low, high]."""
    if step > 0.0:
        return (high - start) / step
    if step < 0.0:
        return (low - start) / step
    return math.inf


@njit(cache=True, nogil=True)
def _interval(scene, o, d, s, end, curve, layer, tau, limit, step, mode, own, presence, record, n):
    """March one part within the canopy.

    Args:
        curve: (s0, q0, q1, q2): the height above ground at s is q0 + q1 t + q2 t^2, t = s - s0, m.
        layer: (g0, g1, g2, least): the canopy's height there, likewise, and the least over the cell, m.
    Returns (status, s, tau, n); status LEFT when the part was crossed.
    """
    s0, q0, q1, q2 = curve
    g0, g1, g2, least = layer
    layers, size = scene.colour.shape[0], scene.colour.shape[2]
    per, which = size / TILES, plane(presence)
    u0, v0 = lattice(scene, o[0], o[1])
    du, dv = lattice(scene, d[0], d[1])
    # h = q / g with h in [0, 1]: |h'| <= (|q'| + |g'|) / g
    first, last = s - s0, end - s0
    steepest = max(abs(q1 + 2 * q2 * first), abs(q1 + 2 * q2 * last))
    steepest += max(abs(g1 + 2 * g2 * first), abs(g1 + 2 * g2 * last))
    rate = max(abs(du) * per, abs(dv) * per, steepest * layers / least, 1e-12)
    while s < end:
        ahead = min(s + NUDGE, end)
        u, v = u0 + du * ahead, v0 + dv * ahead
        i, j = math.floor(u), math.floor(v)
        down = 0 if u - i + v - j < 1.0 else 1
        side = min(
            _exit(u0, du, i, i + 1), _exit(v0, dv, j, j + 1), _exit(u0 + v0, du + dv, i + j + down, i + j + down + 1)
        )
        stop = min(max(side, s + NUDGE), end)
        p, q = rhombus(scene, i, j, down)
        base_u, base_v = (p - i + u0) * per - 0.5, (q - j + v0) * per - 0.5
        while s < stop:
            t = s - s0
            tk = (q0 + (q1 + q2 * t) * t) / (g0 + (g1 + g2 * t) * t) * layers - 0.5
            tu, tv = base_u + du * per * s, base_v + dv * per * s
            k = min(max(math.floor(tk), -1), layers - 1)
            clear = scene.safe[which, k + 1, math.floor(tv) % size, math.floor(tu) % size]
            if clear >= 2:
                # moving less than clear - 1 texels along every axis cannot reach a cell with any opacity
                # within this triangle; the next one is cut from another part of the atlas
                s = min(s + (clear - 1) / rate, stop)
                continue
            length = min(step, stop - s)
            middle = s + 0.5 * length
            t = middle - s0
            tk = (q0 + (q1 + q2 * t) * t) / (g0 + (g1 + g2 * t) * t) * layers - 0.5
            tu, tv = base_u + du * per * middle, base_v + dv * per * middle
            alpha = alpha_at(scene, presence, o[0] + d[0] * middle, o[1] + d[1] * middle, tu, tv, tk)
            if alpha > 0.0 and _meets(scene, o, d, middle, tu, tv, tk, mode, own, presence):
                sigma = extinction(scene, alpha)
                tau += sigma * length
                if record.shape[0] > 0:
                    record[n, S], record[n, DS], record[n, SIGMA] = middle, length, sigma
                    record[n, TU], record[n, TV], record[n, TK] = tu, tv, tk
                    n += 1
                    if n == record.shape[0]:
                        return FULL, s + length, tau, n
                if tau > limit:
                    return OPAQUE, s + length, tau, n
            s += length
    return LEFT, end, tau, n


@njit(cache=True, nogil=True)
def _meets(scene, o, d, s, tu, tv, tk, mode, own, presence):
    """Whether the tree at a sample exists and is one that this ray meets."""
    x, y = o[0] + d[0] * s, o[1] + d[1] * s
    if not stands(scene, presence, x, y, tu, tv, tk):
        return False
    if mode == ALL:
        return True
    foot_x, foot_y = foot(scene, x, y, tu, tv, tk, True)
    same = abs(foot_x - own[0]) < SAME_FOOT and abs(foot_y - own[1]) < SAME_FOOT
    return same == (mode == ONLY_OWN)


@njit(cache=True, nogil=True, inline="always")
def _along(nw, ne, sw, se, px, py, dx, dy):
    """Coefficients of 1, t, t^2 of a bilinear cell's value along (px + dx t, py + dy t), from its north-west corner."""
    a, b = ne - nw, sw - nw
    k = se - sw - a
    return nw + a * px + b * py + k * px * py, a * dx + b * dy + k * (px * dy + py * dx), k * dx * dy


@njit(cache=True, nogil=True)
def _cell(scene, o, d, s, end, i, j, tau, limit, step, solid, mode, own, record, n):
    """March the part of a ray over terrain cell (row i, column j). Returns (status, s, tau, n)."""
    last = scene.elevation.shape[0] - 1
    z = scene.elevation
    r0, r1 = min(max(i, 0), last), min(max(i + 1, 0), last)
    c0, c1 = min(max(j, 0), last), min(max(j + 1, 0), last)
    dx, dy = d[0] / scene.cell, -d[1] / scene.cell
    px = o[0] / scene.cell + 0.5 * last + dx * s - j
    py = 0.5 * last - o[1] / scene.cell + dy * s - i
    f0, f1, f2 = _along(z[r0, c0], z[r0, c1], z[r1, c0], z[r1, c1], px, py, dx, dy)
    q0, q1, q2 = o[2] + d[2] * s - f0, d[2] - f1, -f2
    g = scene.growth
    g0, g1, g2 = _along(g[r0, c0], g[r0, c1], g[r1, c0], g[r1, c1], px, py, dx, dy)
    least = min(g[r0, c0], g[r0, c1], g[r1, c0], g[r1, c1])
    layer = (scene.height * g0, scene.height * g1, scene.height * g2, scene.height * least)
    start, span = s, end - s
    t = 0.0
    presence = scene.presence[min(max(i, 0), last - 1), min(max(j, 0), last - 1)]
    enter, leave = _roots(q2 - layer[2], q1 - layer[1], q0 - layer[0])
    hit, out = _roots(q2, q1, q0)
    while t < span:
        # the next border of the layer behind t closes a part that is wholly above, within or below it
        nearest = span
        for root in (enter, leave, hit, out):
            if t + 1e-9 < root < nearest:
                nearest = root
        middle = 0.5 * (t + nearest)
        height = q0 + (q1 + q2 * middle) * middle
        if height < 0.0:
            if solid:
                return GROUND, start + t, tau, n
        elif height < layer[0] + (layer[1] + layer[2] * middle) * middle and mode != NONE and presence != NOWHERE:
            curve = (start, q0, q1, q2)
            status, s, tau, n = _interval(
                scene, o, d, start + t, start + nearest, curve, layer, tau, limit, step, mode, own, presence, record, n
            )
            if status != LEFT:
                return status, s, tau, n
        t = nearest
    return LEFT, end, tau, n


@njit(cache=True, nogil=True)
def march(scene, o, d, s, tau, limit, step, solid, mode, own, record):
    """Follow a ray from the distance s with the optical depth tau already behind it.

    Args:
        scene: what is marched.
        o, d: origin (m) and unit direction.
        s, tau: distance and optical depth to go on from.
        limit: optical depth at which the rest no longer matters.
        step: longest integration step, m.
        solid: whether the ground stops the ray.
        mode, own: which trees it meets, and the foot of its own.
        record: (M, COLUMNS) to fill with the steps that met matter; (0, COLUMNS) to only sum them.

    Returns:
        (status, s, tau, steps recorded).
    """
    last = scene.elevation.shape[0] - 1
    blocks = scene.block_top.shape[0]
    ceiling = scene.top + scene.layer_top
    dx, dy = d[0] / scene.cell, -d[1] / scene.cell
    x0, y0 = o[0] / scene.cell + 0.5 * last, 0.5 * last - o[1] / scene.cell
    if d[2] < 0.0 and o[2] + d[2] * s > ceiling:
        s = (ceiling - o[2]) / d[2]
    n = ZERO
    while s < scene.reach and not (d[2] >= 0.0 and o[2] + d[2] * s > ceiling):
        x, y = x0 + dx * (s + NUDGE), y0 + dy * (s + NUDGE)
        column, row = math.floor(x / BLOCK), math.floor(y / BLOCK)
        end = min(_exit(x0, dx, column * BLOCK, (column + 1) * BLOCK), _exit(y0, dy, row * BLOCK, (row + 1) * BLOCK))
        end = min(max(end, s + NUDGE), scene.reach)
        low = o[2] + d[2] * (end if d[2] < 0.0 else s)
        if low > scene.block_top[min(max(row, 0), blocks - 1), min(max(column, 0), blocks - 1)] + scene.layer_top:
            s = end
            continue
        j, i = math.floor(x), math.floor(y)
        end = min(end, max(min(_exit(x0, dx, j, j + 1), _exit(y0, dy, i, i + 1)), s + NUDGE))
        status, s, tau, n = _cell(scene, o, d, s, end, i, j, tau, limit, step, solid, mode, own, record, n)
        if status != LEFT:
            return status, s, tau, n
    return LEFT, s, tau, n
