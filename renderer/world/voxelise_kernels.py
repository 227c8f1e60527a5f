"""Compiled inner loops of the voxeliser."""

from __future__ import annotations

import numpy as np
from numba import njit

_SUB = 4
_STEP = 1 << 12
"""Vertices are snapped to this many steps a sub-ray: 0.04 mm for voxels of 0.6 m, and edge functions stay exact in
64 bits."""


@njit(cache=True, inline="always")
def _edge(ax, ay, bx, by, px, py):
    """Twice the signed area of (a, b, p), exact in whole numbers."""
    return (bx - ax) * (py - ay) - (by - ay) * (px - ax)


@njit(cache=True, inline="always")
def _least(ax, ay, bx, by):
    """Least value of the edge function that belongs to a counter-clockwise triangle: the top-left rule gives each
    edge one owner."""
    return 0 if (by < ay or (by == ay and bx < ax)) else 1


@njit(cache=True, inline="always")
def _first(value, wrap):
    """Number of the first sub-ray at or beyond a snapped coordinate (sub-rays stand in the middle of their
    square)."""
    first = (value + _STEP // 2 - 1) // _STEP
    return first if wrap else max(first, 0)


@njit(cache=True, inline="always")
def _last(value, wrap, size):
    """Number of the last sub-ray at or before a snapped coordinate."""
    last = (value - _STEP // 2) // _STEP
    return last if wrap else min(last, size * _SUB - 1)


@njit(cache=True, inline="always")
def _cross(a, b, c):
    """Half the cross product of two sides: its length is the triangle's area."""
    ux, uy, uz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    vx, vy, vz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    return 0.5 * (uy * vz - uz * vy), 0.5 * (uz * vx - ux * vz), 0.5 * (ux * vy - uy * vx)


@njit(cache=True, nogil=True)
def _hits(index, snapped, face, axis, size, wrap, found):
    """Sub-rays of one axis that one face stops.

    Args:
        index: vertices in voxels. snapped: the same in steps. face: three vertex numbers. found: int64 (rows, 4),
        result: cell i, j, k and bit; grown when too small.

    Returns:
        How many, and the array they are in.
    """
    u, v = (axis + 1) % 3, (axis + 2) % 3
    ax, ay, az = snapped[face[0], u], snapped[face[0], v], index[face[0], axis]
    bx, by, bz = snapped[face[1], u], snapped[face[1], v], index[face[1], axis]
    cx, cy, cz = snapped[face[2], u], snapped[face[2], v], index[face[2], axis]
    doubled = _edge(ax, ay, bx, by, cx, cy)
    if doubled == 0:
        return 0, found
    if doubled < 0:
        bx, by, bz, cx, cy, cz = cx, cy, cz, bx, by, bz
        doubled = -doubled
    la, lb, lc = _least(bx, by, cx, cy), _least(cx, cy, ax, ay), _least(ax, ay, bx, by)
    count = 0
    for m in range(_first(min(ax, bx, cx), wrap[u]), _last(max(ax, bx, cx), wrap[u], size[u]) + 1):
        x = m * _STEP + _STEP // 2
        for n in range(_first(min(ay, by, cy), wrap[v]), _last(max(ay, by, cy), wrap[v], size[v]) + 1):
            y = n * _STEP + _STEP // 2
            wa, wb, wc = _edge(bx, by, cx, cy, x, y), _edge(cx, cy, ax, ay, x, y), _edge(ax, ay, bx, by, x, y)
            if wa < la or wb < lb or wc < lc:
                continue
            if count == found.shape[0]:
                # entry by entry: to compile the assignment of a slice takes seconds, for the words of its errors
                grown = np.empty((2 * count, 4), np.int64)
                for entry in range(count):
                    for c in range(4):
                        grown[entry, c] = found[entry, c]
                found = grown
            depth = np.int64(np.floor((wa * az + wb * bz + wc * cz) / doubled))
            found[count, axis] = depth % size[axis] if wrap[axis] else depth
            found[count, u], found[count, v] = (m // _SUB) % size[u], (n // _SUB) % size[v]
            found[count, 3] = (m % _SUB) + _SUB * (n % _SUB)
            count += 1
    return count, found


@njit(cache=True, nogil=True)
def scan(index, world, faces, attributes, wrap, mask, area, normal, sums, parity):
    """Scan-convert every face along the three axes into sub-rays.

    Args:
        index: vertices (V, 3) in voxels. world: the same in metres. faces: (F, 3). attributes: (F, n).
        wrap: (3,) whether i, j, k are periodic.
        mask, area, normal, sums: results, see `Voxels`.
        parity: crossings for `fill_solid`, one voxel longer than `mask` on each side; or a single voxel, when none
        are wanted.
    """
    size = np.array([mask.shape[3], mask.shape[2], mask.shape[1]])
    solid = parity.shape[1] > 1
    found = np.empty((4096, 4), np.int64)
    snapped = np.floor(index * (_SUB * _STEP) + 0.5).astype(np.int64)
    for f in range(faces.shape[0]):
        face = faces[f]
        nx, ny, nz = _cross(world[face[0]], world[face[1]], world[face[2]])
        px, py, pz = _cross(index[face[0]], index[face[1]], index[face[2]])
        length, projected = np.sqrt(nx * nx + ny * ny + nz * nz), (abs(px) + abs(py) + abs(pz)) * _SUB * _SUB
        if length == 0.0 or projected == 0.0:
            continue
        # Each hit stands for as much area as makes the sum over the three axes right on average.
        share = length / projected
        nx, ny, nz = share * nx / length, share * ny / length, share * nz / length
        for axis in range(3):
            count, found = _hits(index, snapped, face, axis, size, wrap, found)
            for h in range(count):
                i, j, k, bit = found[h, 0], found[h, 1], found[h, 2], np.uint16(1 << found[h, 3])
                depth = found[h, axis]
                if solid and depth < size[axis]:
                    start = max(depth + 1, 0)
                    if axis == 0:
                        parity[0, k, j, start] ^= bit
                    elif axis == 1:
                        parity[1, k, start, i] ^= bit
                    else:
                        parity[2, start, j, i] ^= bit
                if depth < 0 or depth >= size[axis]:
                    continue
                mask[axis, k, j, i] |= bit
                area[k, j, i] += share
                normal[k, j, i, 0] += nx
                normal[k, j, i, 1] += ny
                normal[k, j, i, 2] += nz
                for s in range(attributes.shape[1]):
                    sums[k, j, i, s] += share * attributes[f, s]


@njit(cache=True, nogil=True)
def fill_solid(mask, parity):
    """Set the sub-rays that lie inside the mesh: those that crossed its surface an odd number of times before the
    voxel.

    Args:
        mask: uint16 [axis, k, j, i], extended in place.
        parity: crossings mod 2, one bit a sub-ray, in the voxel after the one where they happen; changed in place.
    """
    _, nk, nj, ni = mask.shape
    for k in range(nk):
        for j in range(nj):
            for i in range(ni):
                if i > 0:
                    parity[0, k, j, i] ^= parity[0, k, j, i - 1]
                if j > 0:
                    parity[1, k, j, i] ^= parity[1, k, j - 1, i]
                if k > 0:
                    parity[2, k, j, i] ^= parity[2, k - 1, j, i]
                for axis in range(3):
                    mask[axis, k, j, i] |= parity[axis, k, j, i]
