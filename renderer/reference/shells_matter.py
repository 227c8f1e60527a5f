"""What a ray meets of the shells: tetrahedra, triangles, and the texture between its voxels. Compiled; float64."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from renderer.reference.shells_world import LEAF, NEAREST, OPAQUEST, STRAIGHT

inner = njit(  # type: ignore[call-overload]
    cache=True, error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True
)
"""Compile what only compiled functions call: without the doors from outside it takes two thirds of the time."""

FAR = 1e300
"""A way as good as endless."""


@inner
def leaves(boxes, o, d, far, stack, found):
    """Leaves of a tree whose boxes a ray meets before `far`: their numbers in `found`; returns how many."""
    first = boxes.shape[0] // 2
    x = 1.0 / (d[0] if abs(d[0]) > 1e-300 else 1e-300)
    y = 1.0 / (d[1] if abs(d[1]) > 1e-300 else 1e-300)
    z = 1.0 / (d[2] if abs(d[2]) > 1e-300 else 1e-300)
    count, top = 0, 1
    stack[0] = 0
    while top > 0:
        top -= 1
        node = stack[top]
        box = boxes[node]
        if box[0] > box[3]:
            continue
        a, b = (box[0] - o[0]) * x, (box[3] - o[0]) * x
        near, end = min(a, b), max(a, b)
        a, b = (box[1] - o[1]) * y, (box[4] - o[1]) * y
        near, end = max(near, min(a, b)), min(end, max(a, b))
        a, b = (box[2] - o[2]) * z, (box[5] - o[2]) * z
        near, end = max(near, min(a, b)), min(end, max(a, b))
        if end < 0.0 or near > end or near > far:
            continue
        if node >= first:
            found[count] = node - first
            count += 1
        else:
            stack[top], stack[top + 1] = 2 * node + 1, 2 * node + 2
            top += 2
    return count


@inner
def through(planes, o, d, far):
    """Where a ray is inside a tetrahedron: two distances, the second not beyond the first where it is not."""
    begin, end = 0.0, far
    for k in range(4):
        plane = planes[k]
        slope = plane[0] * d[0] + plane[1] * d[1] + plane[2] * d[2]
        height = plane[0] * o[0] + plane[1] * o[1] + plane[2] * o[2] + plane[3]
        if slope < 0.0:
            begin = max(begin, -height / slope)
        elif slope > 0.0:
            end = min(end, -height / slope)
        elif height > 0.0:
            return 0.0, 0.0
    return begin, end


@inner
def face_met(scene, o, d, far, enough, stack, found):
    """The triangle that a ray meets first before `far`: its number or -1, the distance and two weights.

    Any that is met before `enough` ends the search (Möller and Trumbore 1997).
    """
    best, u, v = -1, 0.0, 0.0
    order = scene.faces.order
    if order.shape[0] == 0:
        return best, far, u, v
    for n in range(leaves(scene.faces.boxes, o, d, far, stack, found)):
        for m in range(found[n] * LEAF, min(found[n] * LEAF + LEAF, order.shape[0])):
            a, b, c = scene.corners[order[m], 0], scene.corners[order[m], 1], scene.corners[order[m], 2]
            e0, e1, e2 = b[0] - a[0], b[1] - a[1], b[2] - a[2]
            f0, f1, f2 = c[0] - a[0], c[1] - a[1], c[2] - a[2]
            p0, p1, p2 = d[1] * f2 - d[2] * f1, d[2] * f0 - d[0] * f2, d[0] * f1 - d[1] * f0
            whole = e0 * p0 + e1 * p1 + e2 * p2
            if whole == 0.0:
                continue
            s0, s1, s2 = o[0] - a[0], o[1] - a[1], o[2] - a[2]
            one = (s0 * p0 + s1 * p1 + s2 * p2) / whole
            if one < -1e-12 or one > 1.0 + 1e-12:
                continue
            q0, q1, q2 = s1 * e2 - s2 * e1, s2 * e0 - s0 * e2, s0 * e1 - s1 * e0
            two = (d[0] * q0 + d[1] * q1 + d[2] * q2) / whole
            if two < -1e-12 or one + two > 1.0 + 1e-12:
                continue
            t = (f0 * q0 + f1 * q1 + f2 * q2) / whole
            if 0.0 < t < far:
                best, far, u, v = order[m], t, one, two
                if far < enough:
                    return best, far, u, v
    return best, far, u, v


@inner
def begin_cells(scene, tet, o, d, t, at, along, cell, crossing):
    """Set out through a tetrahedron's voxels at distance t (Amanatides and Woo 1987).

    Args:
        at, along: (3,) get the ray in voxels. cell: (3,) gets the voxel. crossing: (3,) the distance of each axis' next
            border.
    """
    for k in range(3):
        row = scene.maps[tet, k]
        at[k] = row[0] * o[0] + row[1] * o[1] + row[2] * o[2] + row[3]
        along[k] = row[0] * d[0] + row[1] * d[1] + row[2] * d[2]
        cell[k] = math.floor(at[k] + t * along[k])
        crossing[k] = _border(at[k], along[k], cell[k])


@inner
def _border(at, along, cell):
    """Distance at which one axis leaves its cell."""
    if abs(along) < 1e-300:
        return FAR
    return ((cell + 1 if along > 0.0 else cell) - at) / along


@inner
def next_cells(t, at, along, cell, crossing):
    """Step every axis whose border is behind."""
    for k in range(3):
        while crossing[k] <= t:
            cell[k] += 1 if along[k] > 0.0 else -1
            crossing[k] = _border(at[k], along[k], cell[k])


@inner
def wrapped(index, count, repeats):
    """Index of a voxel beyond the texture's side."""
    return index % count if repeats else min(max(index, 0), count - 1)


@inner
def corner_densities(scene, cell, values):
    """Extinction, or alpha, at the corners of a cell between eight centres; returns the largest, 1 without a look where
    nothing is interpolated."""
    if scene.kinds[0] == NEAREST:
        return 1.0
    depth, height, width = scene.density.shape
    repeats = scene.kinds[2] != 0
    i = cell[0] % width if repeats else min(max(cell[0], -1), width - 1)
    j = cell[1] % height if repeats else min(max(cell[1], -1), height - 1)
    if scene.occupied[min(max(cell[2], -1), depth - 1) + 1, j + 1, i + 1] == 0:
        return 0.0
    largest = 0.0
    for c in range(8):
        i = wrapped(cell[0] + (c & 1), width, repeats)
        j = wrapped(cell[1] + ((c >> 1) & 1), height, repeats)
        k = min(max(cell[2] + (c >> 2), 0), depth - 1)
        values[c] = scene.density[k, j, i]
        largest = max(largest, values[c])
    return largest


@inner
def _weight(c, x, y, z):
    """Share of a corner in a trilinear value."""
    return (x if c & 1 else 1.0 - x) * (y if c & 2 else 1.0 - y) * (z if c & 4 else 1.0 - z)


@inner
def between(scene, values, x, y, z):
    """Extinction inside a cell, 1/m."""
    total = 0.0
    for c in range(8):
        total += values[c] * _weight(c, x, y, z)
    if scene.kinds[0] == STRAIGHT:
        return -math.log1p(-min(total, OPAQUEST)) / scene.numbers[0]
    return total


@inner
def matter(scene, cell, values, x, y, z, out):
    """What is at a place: extinction, colour, normal and glow in `out` (8,).

    Args:
        cell: the voxel, or the cell between eight centres. values: its corners' densities. x, y, z: the place in it.
    """
    depth, height, width = scene.density.shape
    repeats = scene.kinds[2] != 0
    has = scene.kinds[3] != 0
    nearest = scene.kinds[0] == NEAREST
    out[:] = 0.0
    for c in range(1 if nearest else 8):
        i = wrapped(cell[0] + (c & 1), width, repeats)
        j = wrapped(cell[1] + ((c >> 1) & 1), height, repeats)
        k = min(max(cell[2] + (c >> 2), 0), depth - 1)
        share = 1.0 if nearest else _weight(c, x, y, z)
        if nearest:
            out[0] = scene.density[k, j, i]
        else:
            out[0] += share * values[c]
            if scene.kinds[0] != STRAIGHT:
                share *= values[c]
        if share > 0.0:
            for n in range(3):
                out[1 + n] += share * scene.colour[k, j, i, n]
            if has:
                for n in range(4):
                    out[4 + n] += share * scene.normal[k, j, i, n]
    if scene.kinds[0] == STRAIGHT:
        out[0] = -math.log1p(-min(out[0], OPAQUEST)) / scene.numbers[0]
    elif not nearest and out[0] > 0.0:
        for n in range(1, 8):
            out[n] /= out[0]


@inner
def uniform(state):
    """A number in [0, 1) (Vigna 2016, xorshift64*)."""
    x = state[0]
    x ^= x >> np.uint64(12)
    x ^= x << np.uint64(25)
    x ^= x >> np.uint64(27)
    state[0] = x
    return ((x * np.uint64(2685821657736338717)) >> np.uint64(11)) * (1.0 / 9007199254740992.0)
