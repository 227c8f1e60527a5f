"""Normals of a triangle mesh's faces and vertices."""

from __future__ import annotations

import numpy as np


def face_vectors(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Normals of the faces with twice their area as length, (F, 3) [m2]."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    vectors: np.ndarray = np.cross(b - a, c - a)
    return vectors


def vertex_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Unit normals of the vertices: those of their faces, weighted by the angle that each takes there.

    The result does not depend on how a flat part is cut into triangles. A vertex whose faces cancel (the seam of a
    Moebius strip) takes the normal of one of them.

    Args:
        vertices: (V, 3). faces: (F, 3).

    Returns:
        (V, 3) float64.

    Source: Thürmer and Wüthrich 1998, "Computing vertex normals from polygonal facets".
    """
    vectors = face_vectors(vertices, faces)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    normal = vectors / np.where(length > 0, length, 1)
    total = np.zeros((len(vertices), 3))
    for k in range(3):
        at, ahead, behind = (vertices[faces[:, (k + step) % 3]] for step in range(3))
        angle = np.arctan2(length[:, 0], np.einsum("fk,fk->f", ahead - at, behind - at))
        for axis in range(3):
            total[:, axis] += np.bincount(faces[:, k], angle * normal[:, axis], len(vertices))
    size = np.linalg.norm(total, axis=1, keepdims=True)
    lost = size[:, 0] < 1e-9
    one = np.zeros((len(vertices), 3))
    one[faces.ravel()] = np.repeat(normal, 3, axis=0)
    chosen: np.ndarray = np.where(lost[:, None], one, total / np.where(lost[:, None], 1, size))
    return chosen


def corner_normals(vertices: np.ndarray, faces: np.ndarray, crease: float = 0.7) -> np.ndarray:
    """Unit normals (F, 3, 3) of the faces' corners: smooth, but a face's own where the two part by much.

    Args:
        vertices: (V, 3). faces: (F, 3).
        crease: cosine between a face's normal and its vertex's below which the edge is meant to be seen.
    """
    vectors = face_vectors(vertices, faces)
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    own = (vectors / np.where(length > 0, length, 1))[:, None]
    smooth = vertex_normals(vertices, faces)[faces]
    sharp = (smooth * own).sum(axis=-1, keepdims=True) < crease
    chosen: np.ndarray = np.where(sharp, own, smooth)
    return chosen
