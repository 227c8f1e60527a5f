"""Compiled: walks of light from voxels of matter to wherever it could have come from."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

DIMMEST = 1e-3
"""Weight below which a walk ends."""

LONGEST = 1000
"""Meetings after which it does, whatever its weight."""

FARTHEST = 64
"""Repeats of the block that a walk may cross."""


@njit(cache=True, inline="always")
def chance(state):
    """A number in [0, 1) (Vigna 2016, xorshift64*)."""
    x = state[0]
    x ^= x >> np.uint64(12)
    x ^= x << np.uint64(25)
    x ^= x >> np.uint64(27)
    state[0] = x
    return ((x * np.uint64(2685821657736338717)) >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@njit(cache=True, inline="always")
def turn(d, cosine, angle):
    """Turn the unit vector `d` (3,) by an angle of given cosine (Duff et al. 2017)."""
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    sign = 1.0 if d[2] >= 0.0 else -1.0
    a = -1.0 / (sign + d[2])
    b = d[0] * d[1] * a
    x, y = sine * math.cos(angle), sine * math.sin(angle)
    east = x * (1.0 + sign * d[0] * d[0] * a) + y * b + cosine * d[0]
    north = x * sign * b + y * (sign + d[1] * d[1] * a) + cosine * d[1]
    d[2] = -x * sign * d[0] - y * d[1] + cosine * d[2]
    d[0], d[1] = east, north


@njit(cache=True, nogil=True)
def advance(extinction, voxel, repeats, p, d, cell, crossing, depth):
    """Go on from `p` (3,) along `d` until the optical depth is passed: 0 in matter, 1 outside, 2 at the base."""
    size = (extinction.shape[2], extinction.shape[1], extinction.shape[0])
    for axis in range(3):
        ahead = cell[axis] + (1 if d[axis] > 0 else 0)
        crossing[axis] = (ahead * voxel[axis] - p[axis]) / d[axis] if d[axis] != 0 else 1e30
    t = 0.0
    while True:
        axis = 0
        if crossing[1] < crossing[axis]:
            axis = 1
        if crossing[2] < crossing[axis]:
            axis = 2
        sigma = extinction[cell[2], cell[1] % size[1], cell[0] % size[0]]
        passed = sigma * (crossing[axis] - t)
        if passed > depth:
            t += depth / sigma
            for k in range(3):
                p[k] += t * d[k]
            return 0
        depth -= passed
        t = crossing[axis]
        cell[axis] += 1 if d[axis] > 0 else -1
        crossing[axis] += voxel[axis] / abs(d[axis])
        if cell[2] < 0:
            for k in range(3):
                p[k] += t * d[k]
            return 2
        beside = axis < 2 and (cell[axis] < 0 or cell[axis] >= size[axis])
        if cell[2] >= size[2] or (beside and not repeats) or abs(cell[axis]) > FARTHEST * size[axis]:
            return 1


@njit(cache=True, nogil=True)
def walks(extinction, colour, sides, lobe, repeats, base, count, first, last, found):
    """Walks from some layers' voxels, each to where its light came from.

    Args:
        extinction: (K, J, I), 1/m. colour: (K, J, I, 3), share that a meeting leaves. sides: (3,) of the block, m.
        lobe: mean cosine of Henyey and Greenstein's phase function. repeats: whether it does in u and v.
        base: (3,) reflectance of what is under it; negative where it is open. count: walks of each voxel.
        first, last: layers. found: (K, J, I, 16) of zeros, written: as `renderer.shells.transfer.TABLE` names them.
    """
    layers, rows, columns = extinction.shape
    voxel = np.array([sides[0] / columns, sides[1] / rows, sides[2] / layers])
    state = np.zeros(1, np.uint64)
    p, d, cell, crossing, kept = np.zeros(3), np.zeros(3), np.zeros(3, np.int64), np.zeros(3), np.zeros(3)
    for k in range(first, last):
        for j in range(rows):
            for i in range(columns):
                state[0] = np.uint64(((k * 1024 + j) * 1024 + i) * 2 + 1) * np.uint64(0x9E3779B97F4A7C15)
                for n in range(count):
                    cell[0], cell[1], cell[2] = i, j, k
                    for axis in range(3):
                        p[axis] = (cell[axis] + chance(state)) * voxel[axis]
                    # Directions by strata: the heights of a sphere's rings, and the golden angle.
                    rise = 1.0 - 2.0 * (n + chance(state)) / count
                    angle = 2.0 * math.pi * (n * 0.6180339887498949 + 0.5 * chance(state))
                    flat = math.sqrt(max(1.0 - rise * rise, 0.0))
                    start = (flat * math.cos(angle), flat * math.sin(angle), rise)
                    d[0], d[1], d[2] = start
                    kept[:] = 1.0
                    order = walk(extinction, colour, voxel, lobe, repeats, base, p, d, cell, crossing, kept, state)
                    if order >= 0:
                        gather(found[k, j, i], order, start, d, kept, 1.0 / count)


@njit(cache=True, nogil=True)
def walk(extinction, colour, voxel, lobe, repeats, base, p, d, cell, crossing, kept, state):
    """Follow one walk outside: how many meetings it had, or -1 where it ended among them."""
    size = (extinction.shape[2], extinction.shape[1], extinction.shape[0])
    for order in range(LONGEST):
        met = advance(extinction, voxel, repeats, p, d, cell, crossing, -math.log1p(-chance(state)))
        if met == 1 or (met == 2 and base[0] < 0):
            return order
        if met == 2:
            for c in range(3):
                kept[c] *= base[c]
            cell[2], p[2] = 0, 0.0
            d[0], d[1], d[2] = 0.0, 0.0, 1.0
            turn(d, math.sqrt(1.0 - chance(state)), 2.0 * math.pi * chance(state))
        else:
            for c in range(3):
                kept[c] *= colour[cell[2], cell[1] % size[1], cell[0] % size[0], c]
            cosine = 2.0 * chance(state) - 1.0
            if abs(lobe) > 1e-3:
                part = (1.0 - lobe * lobe) / (1.0 + lobe * cosine)
                cosine = min(max((1.0 + lobe * lobe - part * part) / (2.0 * lobe), -1.0), 1.0)
            turn(d, cosine, 2.0 * math.pi * chance(state))
        if max(kept[0], max(kept[1], kept[2])) < DIMMEST:
            return -1
    return -1


@njit(cache=True, nogil=True)
def gather(sums, order, start, d, kept, share):
    """Add a walk that came outside to the sums (16,) of its voxel."""
    if d[2] > 0:
        for c in range(3):
            sums[c] += share * kept[c]
        sums[3] += share * (kept[0] + kept[1] + kept[2]) / 3.0 * start[2]
    if order == 0:
        return
    grey = share * (kept[0] + kept[1] + kept[2]) / 3.0
    mu = start[0] * d[0] + start[1] * d[1] + start[2] * d[2]
    for c in range(3):
        sums[4 + c] += share * kept[c]
        sums[8 + c] += grey * d[c]
        sums[12 + c] += grey * mu * d[c]
    sums[11] += grey * mu
