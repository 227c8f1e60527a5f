"""The rays of the eye through the shells' reference. Compiled; float64.

Every solid that a ray meets, in the order of its entries; between two borders of solids or voxels the matter of all
solids there is added up. The sun is looked for along the ray in strata of equal brightness, were it shining freely:
one ray to it from a place drawn in each, with the chance in proportion to that brightness.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from renderer.reference.shells_light import NODE, STRATA, add_source, add_sunlight, face_light, gather, scratch
from renderer.reference.shells_matter import (
    FAR,
    begin_cells,
    corner_densities,
    face_met,
    inner,
    leaves,
    matter,
    next_cells,
    through,
    uniform,
)
from renderer.reference.shells_world import LEAF, NEAREST

MOST = 64
"""Solids that may share a place."""

PARTS = 2
"""Parts of a way between two borders of interpolated matter."""

CLEAR = 1e-7
"""Transmittance below which nothing behind is looked at."""


@inner
def _solids_met(scene, o, d, far, stack, found, tets, ways):
    """Tetrahedra along a ray, by their entries: numbers in `tets`, distances in `ways`; returns how many."""
    order = scene.solids.order
    count = 0
    for n in range(leaves(scene.solids.boxes, o, d, far, stack, found)):
        for m in range(found[n] * LEAF, min(found[n] * LEAF + LEAF, order.shape[0])):
            begin, end = through(scene.planes[order[m]], o, d, far)
            if begin < end:
                place = count
                while place > 0 and ways[place - 1, 0] > begin:
                    tets[place] = tets[place - 1]
                    ways[place, 0], ways[place, 1] = ways[place - 1, 0], ways[place - 1, 1]
                    place -= 1
                tets[place], ways[place, 0], ways[place, 1] = order[m], begin, end
                count += 1
    return count


@inner
def _matter_at(scene, here, t, one, own, sunny):
    """Extinction of all solids at a place; their sources times it in `own` and `sunny` (3,)."""
    tets, _, count, ats, alongs, cells, _, values, largest = here
    total = 0.0
    own[:] = 0.0
    sunny[:] = 0.0
    for n in range(count[0]):
        if largest[n] == 0.0:
            continue
        at, along, cell = ats[n], alongs[n], cells[n]
        x, y, z = at[0] + t * along[0] - cell[0], at[1] + t * along[1] - cell[1], at[2] + t * along[2] - cell[2]
        matter(scene, cell, values[n], x, y, z, one)
        if one[0] > 0.0:
            total += one[0]
            add_source(scene, tets[n], one, own, sunny)
    return total


@inner
def _linear(own, own2, sunny, sunny2, depth, at, apart, left, light, bright):
    """Radiance of a stretch whose sources are linear in the optical depth (formulas g), none negative.

    Args:
        own, sunny: (3,) sources at depth `at`, and `own2`, `sunny2` `apart` behind it. left: transmittance before it.
        light: (3,) gets what the first send. bright: (3,) is set to what the others send.
    """
    whole = -math.expm1(-depth)
    ramp = whole - depth * math.exp(-depth) if depth > 1e-4 else depth * depth * (0.5 - depth / 3.0)
    for c in range(3):
        slope = (own2[c] - own[c]) / apart
        light[c] += left * max((own[c] - slope * at) * whole + slope * ramp, 0.0)
        slope = (sunny2[c] - sunny[c]) / apart
        bright[c] = left * max((sunny[c] - slope * at) * whole + slope * ramp, 0.0)


@inner
def _stretch(scene, begin, end, left, quantum, here, spare, strata, light, state):
    """Add what comes from a way between two borders; returns the transmittance behind it."""
    one, own, sunny, own2, sunny2, out = spare
    if scene.kinds[0] == NEAREST:
        total = _matter_at(scene, here, begin, one, own, sunny)
        depth = total * (end - begin)
        if depth > 0.0:
            for c in range(3):
                share = -left * math.expm1(-depth) / total
                light[c] += share * own[c]
                out[c] = share * sunny[c]
            gather(begin, end, depth, out, quantum, strata, state)
        return left * math.exp(-depth)
    step = (end - begin) / PARTS
    first, start = 0.0, begin
    for n in range(2 * PARTS):
        here_own, here_sunny = (own, sunny) if n % 2 == 0 else (own2, sunny2)
        second = _matter_at(scene, here, start + (NODE if n % 2 == 0 else 1.0 - NODE) * step, one, here_own, here_sunny)
        for c in range(3):
            here_own[c] /= max(second, 1e-300)
            here_sunny[c] /= max(second, 1e-300)
        if n % 2 == 0:
            first = second
            continue
        depth = 0.5 * step * (first + second)
        if depth > 0.0:
            # extinction linear through both nodes: what lies before the first
            at = NODE * step * (first - 0.5 * (second - first) * NODE / (1.0 - 2.0 * NODE))
            apart = depth * (1.0 - 2.0 * NODE)
            _linear(own, own2, sunny, sunny2, depth, at, apart, left, light, out)
            gather(start, start + step, depth, out, quantum, strata, state)
            left *= math.exp(-depth)
        start += step
    return left


@inner
def _admit(scene, o, d, t, tet, until, here):
    """Take a solid among those that the ray is in; returns whether there was room."""
    tets, ends, count, ats, alongs, cells, crossings, values, largest = here
    n = count[0]
    if n == MOST:
        return False
    tets[n], ends[n] = tet, until
    begin_cells(scene, tet, o, d, t, ats[n], alongs[n], cells[n], crossings[n])
    count[0] = n + 1
    largest[n] = corner_densities(scene, cells[n], values[n])
    return True


@inner
def _advance(scene, t, here):
    """Leave the solids that end at t, and step through the voxels of the others."""
    tets, ends, count, ats, alongs, cells, crossings, values, largest = here
    n = 0
    while n < count[0]:
        if ends[n] <= t:
            last = count[0] - 1
            tets[n], ends[n], largest[n] = tets[last], ends[last], largest[last]
            for k in range(3):
                ats[n, k], alongs[n, k] = ats[last, k], alongs[last, k]
                cells[n, k], crossings[n, k] = cells[last, k], crossings[last, k]
            for k in range(8):
                values[n, k] = values[last, k]
            count[0] = last
            continue
        if min(crossings[n, 0], min(crossings[n, 1], crossings[n, 2])) <= t:
            next_cells(t, ats[n], alongs[n], cells[n], crossings[n])
            largest[n] = corner_densities(scene, cells[n], values[n])
        n += 1


@inner
def _march(scene, o, d, far, quantum, met, here, spare, strata, light, state, stack, found):
    """Radiance of the shells before `far` along a ray, added to `light`; the transmittance, -1 where too many meet."""
    tets, ways = met
    total = _solids_met(scene, o, d, far, stack, found, tets, ways)
    left, next_one, t = 1.0, 0, 0.0
    here[2][0] = 0
    strata[0][0] = 0
    strata[1][0, :] = 0.0
    while left > CLEAR and (here[2][0] > 0 or next_one < total):
        if here[2][0] == 0:
            t = max(t, ways[next_one, 0])
        while next_one < total and ways[next_one, 0] <= t:
            if ways[next_one, 1] > t and not _admit(scene, o, d, t, tets[next_one], ways[next_one, 1], here):
                return -1.0
            next_one += 1
        until = ways[next_one, 0] if next_one < total else FAR
        for n in range(here[2][0]):
            crossing = here[6][n]
            until = min(min(until, here[1][n]), min(crossing[0], min(crossing[1], crossing[2])))
        if until > t and here[2][0] > 0:
            left = _stretch(scene, t, until, left, quantum, here, spare, strata, light, state)
            t = until
        _advance(scene, t, here)
    return left


@inner
def _add_face(scene, face, d, t, u, v, left, strata, spare, light):
    """Add the opaque face behind the shells: the sun's part as one more stratum."""
    own, sunny = spare[1], spare[2]
    stratum = strata[1][strata[0][0] + 1]
    stratum[0] = 0.0
    if face < 0 or left <= CLEAR:
        return
    face_light(scene, face, d, u, v, own, sunny)
    mean = (sunny[0] + sunny[1] + sunny[2]) / 3.0
    for c in range(3):
        light[c] += left * own[c]
        stratum[2 + c] = sunny[c] / max(mean, 1e-300)
        stratum[5 + c] = left * sunny[c]
    stratum[0], stratum[1] = left * mean, t - scene.numbers[2]


@njit(cache=True, nogil=True, error_model="numpy")
def rows(scene, origins, directions, behind, begin, end, quantum, seed, number, total, variance):
    """Follow the rays of one position of some rows of the picture.

    Args:
        origins, directions, behind: (H, W, 3), the last the background's radiance.
        quantum: brightness of a stratum, W m-2 sr-1. seed, number: of the random numbers, of the position.
        total: (H, W, 4) gets the premultiplied radiance and the opacity. variance: (H, W).

    Returns:
        whether at most `MOST` solids shared a place everywhere.
    """
    size = scene.solids.order.shape[0] + 1
    rays = (scratch(), np.zeros(128, np.int64),
            np.zeros(max(scene.solids.boxes.shape[0], scene.faces.boxes.shape[0]), np.int64))  # fmt: skip
    met = (np.zeros(size, np.int64), np.zeros((size, 2)))
    here = (np.zeros(MOST, np.int64), np.zeros(MOST), np.zeros(1, np.int64), np.zeros((MOST, 3)), np.zeros((MOST, 3)),
            np.zeros((MOST, 3), np.int64), np.zeros((MOST, 3)), np.zeros((MOST, 8)), np.zeros(MOST))  # fmt: skip
    spare = (np.zeros(8), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3), np.zeros(3))
    light, last = np.zeros(3), np.zeros(1)
    strata = (np.zeros(1, np.int64), np.zeros((STRATA + 1, 8)))
    state = np.zeros(1, np.uint64)
    for row in range(begin, end):
        state[0] = np.uint64(((seed * 1009 + number) * 65536 + row) * 65536 + 1)
        for _ in range(8):
            uniform(state)
        last[0] = -1.0
        for column in range(origins.shape[1]):
            o = (origins[row, column, 0], origins[row, column, 1], origins[row, column, 2])
            d = (directions[row, column, 0], directions[row, column, 1], directions[row, column, 2])
            light[:] = 0.0
            face, far, u, v = face_met(scene, o, d, FAR, 0.0, rays[1], rays[2])
            left = _march(scene, o, d, far, quantum, met, here, spare, strata, light, state, rays[1], rays[2])
            if left < 0.0:
                return False
            _add_face(scene, face, d, far, u, v, left, strata, spare, light)
            variance[row, column] += add_sunlight(scene, o, d, strata, last, light, *rays)
            left = left if face < 0 and left > CLEAR else 0.0
            for c in range(3):
                total[row, column, c] += light[c] + left * behind[row, column, c]
            total[row, column, 3] += 1.0 - left
    return True
