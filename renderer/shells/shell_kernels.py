"""Compiled: planes, maps and volumes of tetrahedra."""

from __future__ import annotations

import numpy as np
from numba import njit

OPPOSITE = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])
"""Corners of the face opposite each corner."""


@njit(cache=True, nogil=True)
def cells(positions, tets, texture, thinnest, planes, to_texture, volumes):
    """Write what `renderer.shells.shell.cell_geometry` gives.

    Args:
        positions: (P, 3). tets: (N, 4) rising vertices. texture: (N, 4, 3).
        thinnest: volume over the cube of the longest edge below which a cell is flat.
        planes: (N, 4, 4), to_texture: (N, 3, 4), volumes: (N,), written.
    """
    point, rise = np.empty((4, 3)), np.empty((4, 3))
    for n in range(len(tets)):
        longest = 0.0
        for k in range(4):
            square = 0.0
            for axis in range(3):
                point[k, axis] = positions[tets[n, k], axis]
                square += (point[k, axis] - point[0, axis]) ** 2
            longest = max(longest, square)
        to_texture[n] = 0.0
        for k in range(4):
            # In rising order of vertices, which both owners of a face share: their planes differ in sign alone.
            a, b, c = OPPOSITE[k]
            u0, u1, u2 = point[b, 0] - point[a, 0], point[b, 1] - point[a, 1], point[b, 2] - point[a, 2]
            v0, v1, v2 = point[c, 0] - point[a, 0], point[c, 1] - point[a, 1], point[c, 2] - point[a, 2]
            x, y, z = u1 * v2 - u2 * v1, u2 * v0 - u0 * v2, u0 * v1 - u1 * v0
            height = (
                x * (point[k, 0] - point[a, 0]) + y * (point[k, 1] - point[a, 1]) + z * (point[k, 2] - point[a, 2])
            )
            if k == 3:
                # The determinant of the corners as they stand: the faces opposite 0 and 2 have it, too, but for signs.
                volumes[n] = height / 6
            length = np.sqrt(x * x + y * y + z * z)
            scale = (-1.0 if height > 0 else 1.0) / length if length > 0 else 0.0
            planes[n, k, 0], planes[n, k, 1], planes[n, k, 2] = x * scale, y * scale, z * scale
            planes[n, k, 3] = -(x * point[a, 0] + y * point[a, 1] + z * point[a, 2]) * scale
            if height != 0:
                for axis in range(3):
                    rise[k, axis] = (x if axis == 0 else y if axis == 1 else z) / height
        if abs(volumes[n]) <= thinnest * longest**1.5:
            volumes[n] = 0.0
            for row in range(3):
                to_texture[n, row, 3] = texture[n, :, row].mean()
            continue
        for row in range(3):
            for k in range(1, 4):
                step = texture[n, k, row] - texture[n, 0, row]
                for axis in range(3):
                    to_texture[n, row, axis] += step * rise[k, axis]
            at = texture[n, 0, row]
            for axis in range(3):
                at -= to_texture[n, row, axis] * point[0, axis]
            to_texture[n, row, 3] = at
