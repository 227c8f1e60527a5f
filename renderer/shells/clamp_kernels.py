"""Compiled: which prisms of a shell overlap, by separating axes of their tetrahedra."""

from __future__ import annotations

import numpy as np
from numba import njit

CELLS = np.array([[0, 1, 2, 5], [0, 1, 4, 5], [0, 3, 4, 5]])
"""Corners of a prism's tetrahedra among A, B, C, A', B', C'."""

FACES = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])
"""Corners of a tetrahedron's faces."""

EDGES = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])
"""Corners of its edges."""

SIDES = np.array([[0, 1, 2], [3, 4, 5], [0, 1, 4], [1, 2, 5], [0, 2, 5]])
"""Corners of planes along a prism's skin."""


@njit(cache=True, nogil=True)
def _apart(a, b, x, y, z, slack):
    """Whether the points a (N, 3) and b (M, 3) overlap by no more than `slack` [m] along the direction x, y, z."""
    length = np.sqrt(x * x + y * y + z * z)
    if length < 1e-30:
        return False
    low_a, high_a, low_b, high_b = np.inf, -np.inf, np.inf, -np.inf
    for k in range(len(a)):
        place = a[k, 0] * x + a[k, 1] * y + a[k, 2] * z
        low_a, high_a = min(low_a, place), max(high_a, place)
    for k in range(len(b)):
        place = b[k, 0] * x + b[k, 1] * y + b[k, 2] * z
        low_b, high_b = min(low_b, place), max(high_b, place)
    return high_a <= low_b + slack * length or high_b <= low_a + slack * length


@njit(cache=True, nogil=True)
def _apart_across(a, b, u0, u1, u2, v0, v1, v2, slack):
    """The same along the cross product of two directions."""
    return _apart(a, b, u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0, slack)


@njit(cache=True, nogil=True)
def _apart_by_planes(a, b, own, planes, slack):
    """The same along the normals of planes through three of the points `own` each."""
    for k in range(len(planes)):
        p, q, r = planes[k]
        u, v = own[q] - own[p], own[r] - own[p]
        if _apart_across(a, b, u[0], u[1], u[2], v[0], v[1], v[2], slack):
            return True
    return False


@njit(cache=True, nogil=True)
def _cells_overlap(a, b, slack):
    """Whether two tetrahedra (4, 3) overlap: no face's normal and no pair of edges gives an axis that parts them."""
    if _apart_by_planes(a, b, a, FACES, slack) or _apart_by_planes(a, b, b, FACES, slack):
        return False
    for i in range(6):
        u = a[EDGES[i, 1]] - a[EDGES[i, 0]]
        for j in range(6):
            v = b[EDGES[j, 1]] - b[EDGES[j, 0]]
            if _apart_across(a, b, u[0], u[1], u[2], v[0], v[1], v[2], slack):
                return False
    return True


@njit(cache=True, nogil=True)
def _prisms_overlap(a, b, slack):
    """Whether two prisms (6, 3) overlap, as the three tetrahedra that each is."""
    if _apart_by_planes(a, b, a, SIDES, slack) or _apart_by_planes(a, b, b, SIDES, slack):
        return False
    for i in range(3):
        cell = a[CELLS[i]]
        for j in range(3):
            if _cells_overlap(cell, b[CELLS[j]], slack):
                return True
    return False


@njit(cache=True, nogil=True)
def overlapping_prisms(positions, corners, active, slack):
    """Pairs of prisms that overlap.

    Boxes along the axes, sorted along x, leave the pairs to look at closely; then separating axes (Gottschalk, Lin and
    Manocha 1996): faces that touch do not count.

    Args:
        positions: (P, 3) metres. corners: (F, 6) of each prism, A < B < C and their copies.
        active: (F,) bool; a pair is looked at where one of the two is.
        slack: depth below which an overlap does not count, m.

    Returns:
        (N, 2) int64, the lower number first.
    """
    count = len(corners)
    low, high = np.empty((count, 3)), np.empty((count, 3))
    for f in range(count):
        for k in range(3):
            low[f, k], high[f, k] = np.inf, -np.inf
            for corner in corners[f]:
                low[f, k] = min(low[f, k], positions[corner, k])
                high[f, k] = max(high[f, k], positions[corner, k])
    order = np.argsort(low[:, 0])
    found = [(0, 0)]
    for place in range(count):
        i = order[place]
        for after in range(place + 1, count):
            j = order[after]
            if low[j, 0] >= high[i, 0] - slack:
                break
            if not (active[i] or active[j]):
                continue
            if low[j, 1] >= high[i, 1] - slack or low[i, 1] >= high[j, 1] - slack:
                continue
            if low[j, 2] >= high[i, 2] - slack or low[i, 2] >= high[j, 2] - slack:
                continue
            if _prisms_overlap(positions[corners[i]], positions[corners[j]], slack):
                found.append((min(i, j), max(i, j)))
    pairs = np.empty((len(found) - 1, 2), np.int64)
    for k in range(1, len(found)):
        pairs[k - 1, 0], pairs[k - 1, 1] = found[k]
    return pairs
