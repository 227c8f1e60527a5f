"""The mesh that a shell is put over: vertices merged by position, texture coordinates on the corners of its faces.

Merged vertices make the topology true across the seams of the texture, which are then only jumps of the corners'
coordinates; where the texture repeats, a jump by whole numbers shows nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from renderer.core.errors import AssetError


@dataclass(frozen=True)
class BaseMesh:
    """Triangles with texture coordinates.

    Args:
        vertices: (V, 3) float64, metres, z up, each used by a face.
        faces: (F, 3) int32, counter-clockwise seen from the front.
        corner_uv: (F, 3, 2) float64, texture coordinates of each face's corners.
        notes: what was assumed or left out while making it, in words.
    """

    vertices: np.ndarray
    faces: np.ndarray
    corner_uv: np.ndarray
    notes: tuple[str, ...] = ()


def from_corners(
    corners: np.ndarray, corner_uv: np.ndarray, notes: tuple[str, ...] = (), tolerance: float = 0.0
) -> BaseMesh:
    """A mesh from its triangles' corners: those at one position become one vertex.

    Args:
        corners: (F, 3, 3) metres. corner_uv: (F, 3, 2).
        notes: of whoever made the corners.
        tolerance: positions at most this far apart are one, m.

    Returns:
        The mesh; vertices stand in the order in which the corners name them first. Faces two of whose corners fall
        together are left out, which a note says.

    Raises:
        AssetError: no face is left.
    """
    points = corners.reshape(-1, 3) + 0.0  # -0 and 0 are one place
    _, first, merged = np.unique(points, axis=0, return_index=True, return_inverse=True)
    merged = merged.reshape(-1)
    if tolerance > 0:
        merged, first = _joined(points, merged, first, tolerance)
    faces = merged.reshape(-1, 3)
    whole = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    if not whole.any():
        raise AssetError("faces", "have no area", "at least 1 face with an area")
    if not whole.all():
        notes = (*notes, f"{int((~whole).sum()):,} faces whose corners fall together were left out")
    faces = faces[whole]
    used = np.unique(faces)
    used = used[np.argsort(first[used], kind="stable")]
    number = np.empty(len(first), np.int32)
    number[used] = np.arange(len(used), dtype=np.int32)
    return BaseMesh(points[first[used]], number[faces], np.array(corner_uv[whole], np.float64), notes)


def side_by_side(parts: list[BaseMesh]) -> BaseMesh:
    """Several meshes as one; where they touch, they stay apart."""
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    return BaseMesh(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + start for part, start in zip(parts, starts)]).astype(np.int32),
        np.concatenate([part.corner_uv for part in parts]),
        tuple(note for part in parts for note in part.notes),
    )


def _joined(
    points: np.ndarray, merged: np.ndarray, first: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """The numbering `merged` (N,) of `points` with places at most `tolerance` apart joined, and each number's first
    point; chains of such places become one."""
    pairs = cKDTree(points[first]).query_pairs(tolerance, output_type="ndarray")
    links = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(first), len(first)))
    count, label = connected_components(links, directed=False)
    earliest = np.full(count, len(points), np.int64)
    np.minimum.at(earliest, label, first)
    return label[merged], earliest


def flat_uv(corner_uv: np.ndarray) -> np.ndarray:
    """Numbers of the faces whose texture coordinates span no area, (N,)."""
    a, b = corner_uv[:, 1] - corner_uv[:, 0], corner_uv[:, 2] - corner_uv[:, 0]
    spread = np.maximum(np.abs(a).max(axis=1), np.abs(b).max(axis=1))
    return np.flatnonzero(np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) <= 1e-9 * spread**2)
