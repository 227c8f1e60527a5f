"""How often a mesh winds around points: what is inside, even of open or self-intersecting meshes.

The generalised winding number (Jacobson, Kavan and Sorkine-Hornung 2013, section 3) is the sum of the solid angles of
the triangles (Van Oosterom and Strackee 1983, equation 8) over 4 pi: 1 inside a closed surface, 0 outside, 2 where two
parts overlap, and smooth across a hole. Far groups of triangles count as one dipole (Barill, Dickson, Schmidt, Levin
and Jacobson 2018, section 3).
"""

from __future__ import annotations

import math

import numba
import numpy as np

LEAF = 8
"""Triangles of a group that is not divided further."""

FAR = 2.0
"""Distance over the group's radius from which it counts as one dipole."""


def winding_numbers(vertices: np.ndarray, faces: np.ndarray, points: np.ndarray) -> np.ndarray:
    """The winding number of a mesh around points.

    Args:
        vertices: (V, 3). faces: (F, 3), front where they run counter-clockwise. points: (N, 3).

    Returns:
        (N,) float64, within about 0.04 of the exact sum.
    """
    corners = np.asarray(vertices, float)[np.asarray(faces)]
    corners = corners[_along_a_curve(corners.mean(axis=1))]
    levels = [_groups(corners, LEAF << level) for level in range(_depth(len(corners)))]
    starts = np.cumsum([0] + [len(level) for level in levels])
    found = np.empty(len(points))
    _wind(corners, np.concatenate(levels), starts, np.ascontiguousarray(points, np.float64), found)
    return found


def _depth(count: int) -> int:
    return max(1, math.ceil(math.log2(max(count / LEAF, 1))) + 1)


def _along_a_curve(centres: np.ndarray) -> np.ndarray:
    """Order along Morton's curve: neighbours in it are neighbours in space."""
    low, high = centres.min(axis=0), centres.max(axis=0)
    cell = ((centres - low) / max(float((high - low).max()), 1e-300) * 1023).astype(np.uint64)
    code = np.zeros(len(centres), np.uint64)
    for bit in range(10):
        for axis in range(3):
            code |= ((cell[:, axis] >> np.uint64(bit)) & np.uint64(1)) << np.uint64(3 * bit + axis)
    return np.argsort(code, kind="stable")


def _groups(corners: np.ndarray, size: int) -> np.ndarray:
    """Each run of `size` triangles: centre (3), sum of area times normal (3) and radius, (G, 7)."""
    starts = np.arange(0, len(corners), size)
    vector = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    area = np.linalg.norm(vector, axis=1) + 1e-300
    weight = np.add.reduceat(area, starts)
    centre = np.add.reduceat(area[:, None] * corners.mean(axis=1), starts, axis=0) / weight[:, None]
    own = np.repeat(centre, np.diff(np.append(starts, len(corners))), axis=0)
    reach = np.linalg.norm(corners - own[:, None], axis=-1).max(axis=1)
    return np.concatenate(
        [centre, np.add.reduceat(vector, starts, axis=0), np.maximum.reduceat(reach, starts)[:, None]], axis=1
    )


@numba.njit(cache=True, nogil=True)
def _wind(corners, groups, starts, points, found):
    top = len(starts) - 2
    stack_level, stack_number = np.empty(64, np.int64), np.empty(64, np.int64)
    for n in range(len(points)):
        x, y, z = points[n]
        total = 0.0
        stack_level[0], stack_number[0] = top, 0
        held = 1
        while held:
            held -= 1
            level, number = stack_level[held], stack_number[held]
            group = groups[starts[level] + number]
            dx, dy, dz = group[0] - x, group[1] - y, group[2] - z
            square = dx * dx + dy * dy + dz * dz
            if square > (FAR * group[6]) ** 2:
                total += (group[3] * dx + group[4] * dy + group[5] * dz) / (square * math.sqrt(square))
            elif level > 0:
                for child in range(2 * number, min(2 * number + 2, starts[level] - starts[level - 1])):
                    stack_level[held], stack_number[held] = level - 1, child
                    held += 1
            else:
                for f in range(number * LEAF, min(number * LEAF + LEAF, len(corners))):
                    total += _solid_angle(corners[f], x, y, z)
        found[n] = total / (4 * math.pi)


@numba.njit(cache=True, nogil=True)
def _solid_angle(corner, x, y, z):
    ax, ay, az = corner[0, 0] - x, corner[0, 1] - y, corner[0, 2] - z
    bx, by, bz = corner[1, 0] - x, corner[1, 1] - y, corner[1, 2] - z
    cx, cy, cz = corner[2, 0] - x, corner[2, 1] - y, corner[2, 2] - z
    a = math.sqrt(ax * ax + ay * ay + az * az)
    b = math.sqrt(bx * bx + by * by + bz * bz)
    c = math.sqrt(cx * cx + cy * cy + cz * cz)
    volume = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
    ab, bc, ca = ax * bx + ay * by + az * bz, bx * cx + by * cy + bz * cz, cx * ax + cy * ay + cz * az
    return 2 * math.atan2(volume, a * b * c + ab * c + bc * a + ca * b)
