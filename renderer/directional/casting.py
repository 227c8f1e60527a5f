"""Parallel rays from the texels of a box's face to the points of the cloud."""

from __future__ import annotations

import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.cloud import part_of
from renderer.directional.mesh_rays import MeshRays

NONE = 0xFFFFFFFF
"""Number of the point that a texel without any sees."""

AXES = ((1, 2, 0), (1, 2, 0), (0, 2, 1), (0, 2, 1), (0, 1, 2), (0, 1, 2))
"""First and second axis of each face, along u and v, and that of its normal: -x, +x, -y, +y, -z, +z."""


def face_frame(face: int) -> np.ndarray:
    """(3, 3) first axis, second axis and outward normal of a face, in rows; left-handed where the face is."""
    frame = np.zeros((3, 3))
    for row, axis in enumerate(AXES[face]):
        frame[row, axis] = 1.0
    frame[2] *= 1 if face % 2 else -1
    return frame


def face_middles(box: np.ndarray, face: int, texels: int) -> np.ndarray:
    """Middles (d * d, 3) [m] of a face's texels, row j along the second axis, column i along the first."""
    first, second, along = AXES[face]
    share = (np.arange(texels) + 0.5) / texels
    place = np.zeros((texels, texels, 3))
    place[..., first] = box[0, first] + share * (box[1, first] - box[0, first])
    place[..., second] = (box[0, second] + share * (box[1, second] - box[0, second]))[:, None]
    place[..., along] = box[face % 2, along]
    return place.reshape(-1, 3)


class Caster:
    """A subject under rays, with its cloud.

    Args:
        subject, cloud: as baked.
    """

    def __init__(self, subject: Arrays, cloud: Arrays) -> None:
        self.box = np.asarray(subject["box"])
        self._cuts, self._first = cloud["cuts"], cloud["first"]
        self._rays = MeshRays(subject["vertices"], subject["faces"])

    def points(self, origins: np.ndarray, towards: np.ndarray) -> np.ndarray:
        """Numbers (N,) uint32 of the points that are seen from places in a direction.

        Args:
            origins: (N, 3) [m]. towards: (3,) unit vector of the rays.
        """
        found = self._rays.met(origins, towards)
        seen = np.full(len(origins), NONE, np.uint32)
        hit = np.flatnonzero(found["primID"] >= 0)
        triangle = found["primID"][hit]
        first = self._first[triangle, 0]
        if self._first.shape[1] == 2:
            back = found["Ng"][hit] @ np.asarray(towards, np.float32) > 0
            first = np.where(back, self._first[triangle, 1], first)
        seen[hit] = first + part_of(found["u"][hit], found["v"][hit], self._cuts[triangle])
        return seen
