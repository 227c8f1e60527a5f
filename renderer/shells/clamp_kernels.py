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


EVERY = np.arange(6)
"""All corners of a prism."""


@njit(cache=True, nogil=True)
def _apart(a, of_a, b, of_b, x, y, z, slack):
    """Whether the points `of_a` among a (6, 3) and `of_b` among b (6, 3) overlap by no more than `slack` [m] along the
    direction x, y, z."""
    length = np.sqrt(x * x + y * y + z * z)
    if length < 1e-30:
        return False
    low_a, high_a, low_b, high_b = np.inf, -np.inf, np.inf, -np.inf
    for k in of_a:
        place = a[k, 0] * x + a[k, 1] * y + a[k, 2] * z
        low_a, high_a = min(low_a, place), max(high_a, place)
    for k in of_b:
        place = b[k, 0] * x + b[k, 1] * y + b[k, 2] * z
        low_b, high_b = min(low_b, place), max(high_b, place)
    return high_a <= low_b + slack * length or high_b <= low_a + slack * length


@njit(cache=True, nogil=True)
def _apart_across(a, of_a, b, of_b, own, p, q, other, r, s, slack):
    """The same along the cross product of the edges from p to q of `own` and from r to s of `other`."""
    u0, u1, u2 = own[q, 0] - own[p, 0], own[q, 1] - own[p, 1], own[q, 2] - own[p, 2]
    v0, v1, v2 = other[s, 0] - other[r, 0], other[s, 1] - other[r, 1], other[s, 2] - other[r, 2]
    return _apart(a, of_a, b, of_b, u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0, slack)


@njit(cache=True, nogil=True)
def _apart_by_planes(a, b, own, planes, slack):
    """The same for whole prisms along the normals of planes through three of the points `own` each."""
    for k in range(len(planes)):
        if _apart_across(a, EVERY, b, EVERY, own, planes[k, 0], planes[k, 1], own, planes[k, 0], planes[k, 2], slack):
            return True
    return False


@njit(cache=True, nogil=True)
def _cells_overlap(a, of_a, b, of_b, slack):
    """Whether two tetrahedra overlap: no face's normal and no pair of edges gives an axis that parts them."""
    for k in range(4):
        for own, of_own in ((a, of_a), (b, of_b)):
            p, q, r = of_own[FACES[k, 0]], of_own[FACES[k, 1]], of_own[FACES[k, 2]]
            if _apart_across(a, of_a, b, of_b, own, p, q, own, p, r, slack):
                return False
    for i in range(6):
        for j in range(6):
            p, q = of_a[EDGES[i, 0]], of_a[EDGES[i, 1]]
            r, s = of_b[EDGES[j, 0]], of_b[EDGES[j, 1]]
            if _apart_across(a, of_a, b, of_b, a, p, q, b, r, s, slack):
                return False
    return True


def close_prisms(positions: np.ndarray, corners: np.ndarray, slack: float, most: int) -> np.ndarray:
    """Pairs of prisms whose convex hulls may overlap.

    Boxes along the axes, sorted along x, leave the pairs that are looked at by the planes of their own sides. Prisms
    shortened in any way stay within these hulls, so no other pair of them can overlap either.

    Args:
        positions: (P, 3) metres. corners: (F, 6) of each prism, A < B < C and their copies.
        slack: depth below which an overlap does not count, m.
        most: how many pairs are wanted at most.

    Returns:
        (N, 2) int32, the lower number first; more than `most` of them, but not all, where there are more.
    """
    points = positions[corners]
    low, high = points.min(axis=1), points.max(axis=1)
    order = np.argsort(low[:, 0])
    room = 64 * len(corners)
    while True:
        pairs = np.empty((room, 2), np.int32)
        found = _close(points[order], low[order], high[order], slack, pairs)
        if found <= room or room > most:
            return np.sort(order[pairs[: min(found, room)]].astype(np.int32), axis=1)
        room *= 4


@njit(cache=True, nogil=True)
def _close(points, low, high, slack, pairs):
    """Write pairs of prisms whose hulls may overlap, and return how many there are; one more than fit where there are
    more."""
    found = 0
    for i in range(len(points)):
        for j in range(i + 1, len(points)):
            if low[j, 0] >= high[i, 0] - slack:
                break
            if low[j, 1] >= high[i, 1] - slack or low[i, 1] >= high[j, 1] - slack:
                continue
            if low[j, 2] >= high[i, 2] - slack or low[i, 2] >= high[j, 2] - slack:
                continue
            a, b = points[i], points[j]
            if _apart_by_planes(a, b, a, SIDES, slack) or _apart_by_planes(a, b, b, SIDES, slack):
                continue
            if found == len(pairs):
                return found + 1
            pairs[found, 0], pairs[found, 1] = i, j
            found += 1
    return found


@njit(cache=True, nogil=True)
def overlapping(points, pairs, slack):
    """Which pairs (N, 2) of prisms (F, 6, 3) overlap, as the three tetrahedra that each is, (N,) bool.

    By separating axes (Gottschalk, Lin and Manocha 1996): faces that touch do not count.
    """
    found = np.zeros(len(pairs), np.bool_)
    for k in range(len(pairs)):
        a, b = points[pairs[k, 0]], points[pairs[k, 1]]
        if _apart_by_planes(a, b, a, SIDES, slack) or _apart_by_planes(a, b, b, SIDES, slack):
            continue
        for i in range(3):
            for j in range(3):
                if not found[k] and _cells_overlap(a, CELLS[i], b, CELLS[j], slack):
                    found[k] = True
    return found
