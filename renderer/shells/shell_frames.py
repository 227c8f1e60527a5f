"""Tangent frames of a mesh's corners, from the derivatives of position by texture coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.shells.base_mesh import BaseMesh, flat_uv
from renderer.world.mesh_normals import face_vectors, vertex_normals


@dataclass(frozen=True)
class Frames:
    """Frames at the corners of triangles.

    Args:
        tangent: (F, 3, 3) unit vectors along which u grows, at right angles to the corner's normal.
        binormal: (F, 3, 3) unit vectors at right angles to both, to the side on which v grows.
        normal: (F, 3, 3) unit normals of the vertices.
        guessed: (N,) int64, triangles whose texture coordinates span no area: any tangent is as good there.
    """

    tangent: np.ndarray
    binormal: np.ndarray
    normal: np.ndarray
    guessed: np.ndarray


def tangent_frames(base: BaseMesh) -> Frames:
    """Frames at a mesh's corners; never NaN.

    Dufort 2005, section 3.1, after Fernando and Kilgard 2003: T is the derivative of position by u, and B = N x T.
    Where the texture is mirrored that B looks against v, so here it has v's side.

    Source of the tangent where none follows from the texture: Duff et al. 2017, "Building an orthonormal basis,
    revisited".
    """
    normal = vertex_normals(base.vertices, base.faces)[base.faces]
    places = base.vertices[base.faces]
    e1, e2 = places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]
    (u1, v1), (u2, v2) = ((base.corner_uv[:, k] - base.corner_uv[:, 0]).T for k in (1, 2))
    area = u1 * v2 - u2 * v1
    guessed = flat_uv(base.corner_uv)
    along = (e1 * v2[:, None] - e2 * v1[:, None]) * np.sign(area)[:, None]
    along[guessed] = 0
    tangent = _beside(np.repeat(along[:, None], 3, axis=1), normal)
    # The corner's normal may lie along u on a mesh that folds: there, too, any tangent does.
    length = np.linalg.norm(tangent, axis=-1, keepdims=True)
    size = np.linalg.norm(along, axis=-1)[:, None, None]
    lost = length <= 1e-9 * np.maximum(size, 1e-300)
    tangent = np.where(lost, any_tangent(normal), tangent / np.where(lost, 1, length))
    side = np.where(area < 0, -1.0, 1.0)
    # The side of v: against the normal's where the triangle itself looks away from it.
    side *= np.where(np.einsum("fk,fck->f", face_vectors(base.vertices, base.faces), normal) < 0, -1.0, 1.0)
    return Frames(tangent, np.cross(normal, tangent) * side[:, None, None], normal, guessed)


def any_tangent(normal: np.ndarray) -> np.ndarray:
    """A unit vector at right angles to each of the unit vectors (..., 3), without a branch at the poles."""
    x, y, z = np.moveaxis(normal, -1, 0)
    sign = np.where(z < 0, -1.0, 1.0)
    a = -1 / (sign + z)
    return np.stack([1 + sign * x * x * a, sign * x * y * a, -sign * x], axis=-1)


def _beside(vectors: np.ndarray, normal: np.ndarray) -> np.ndarray:
    return vectors - np.einsum("...k,...k->...", vectors, normal)[..., None] * normal
