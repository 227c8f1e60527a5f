"""Voxelises triangle meshes: opacity from exact coverage, mean normal, mean colour.

Sixteen sub-rays cross each voxel along each of the grid's three axes. A voxel's opacity along an axis is the share
of its sub-rays that meet the mesh inside it; triangles are scan-converted in whole numbers with a fill rule, so that
two triangles sharing an edge neither both take nor both miss a sub-ray.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from renderer.core.errors import AssetError
from renderer.world.voxelise_kernels import fill_solid, scan

SUB = 4
"""Sub-rays a voxel side; 16 cross it along each axis."""


@dataclass(frozen=True)
class Grid:
    """A block of voxels in any affine frame.

    Attributes:
        origin: world position (3,) [m] of the corner of voxel (0, 0, 0).
        axes: rows (3, 3) [m], the voxel's three sides in the world, along i, j and k.
        shape: voxels (ni, nj, nk) along i, j and k.
        wrap: whether the grid is periodic along i, j, k.
    """

    origin: np.ndarray
    axes: np.ndarray
    shape: tuple[int, int, int]
    wrap: tuple[bool, bool, bool] = (False, False, False)

    def to_index(self, points: np.ndarray) -> np.ndarray:
        """World points (..., 3) [m] in voxels from the grid's corner."""
        return (np.asarray(points, float) - self.origin) @ np.linalg.inv(self.axes)


@dataclass(frozen=True)
class Voxels:
    """What a mesh leaves in a grid; arrays are indexed [k, j, i].

    Attributes:
        mask: uint16 [axis, k, j, i], one bit a sub-ray, set where the mesh stops it inside the voxel.
        area: float32, mesh area inside the voxel [m2], estimated from the sub-rays that meet it.
        normal: float32 [k, j, i, 3], sum of area times unit face normal [m2], world axes, oriented by the faces'
        winding.
        attributes: float32 [k, j, i, n], sum of area times the faces' attributes [m2].
    """

    mask: np.ndarray
    area: np.ndarray
    normal: np.ndarray
    attributes: np.ndarray = field(repr=False)

    def opacity(self) -> np.ndarray:
        """Share of sub-rays stopped, mean of the three axes, [k, j, i] in [0, 1]."""
        return opacity_of(self.mask)

    def mean_attributes(self) -> np.ndarray:
        """Area-weighted mean of the faces' attributes, 0 where there is no face."""
        return self.attributes / np.maximum(self.area, np.float32(1e-30))[..., None]


def opacity_of(mask: np.ndarray) -> np.ndarray:
    """Mean over the three axes of the share of bits set in `mask` (3, ...), float32."""
    return (np.bitwise_count(mask).astype(np.float32).sum(axis=0) / np.float32(3 * SUB * SUB)).astype(np.float32)


def voxelise(
    vertices: np.ndarray, faces: np.ndarray, attributes: np.ndarray, grid: Grid, *, solid: bool = False
) -> Voxels:
    """Voxelise a mesh.

    Args:
        vertices: (V, 3) [m]. faces: (F, 3) indices. attributes: (F, n) per face, as linear colours.
        grid: where to; what lies outside is left out, save along periodic axes.
        solid: fill the inside, for a watertight mesh; its colour there is that of no face.

    Raises:
        AssetError: no faces, indices out of range, coordinates that are not finite, or `solid` for a mesh with open
        edges.
    """
    vertices, faces = np.asarray(vertices, float), np.ascontiguousarray(faces, np.int64)
    if faces.ndim != 2 or len(faces) == 0:
        raise AssetError("mesh", "has no faces", "at least one triangle")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise AssetError("mesh.faces", "name vertices that do not exist", f"0 to {len(vertices) - 1}")
    if not np.isfinite(vertices).all():
        raise AssetError("mesh.vertices", "are not all finite numbers")
    if solid and any(grid.wrap):
        raise ValueError("a periodic grid has no outside from which to fill")
    if solid and not is_closed(faces):
        raise AssetError("mesh", "is not watertight and cannot be filled", "a closed mesh, or its surface alone")
    ni, nj, nk = grid.shape
    attributes = np.ascontiguousarray(attributes, np.float32).reshape(len(faces), -1)
    voxels = Voxels(
        np.zeros((3, nk, nj, ni), np.uint16),
        np.zeros((nk, nj, ni), np.float32),
        np.zeros((nk, nj, ni, 3), np.float32),
        np.zeros((nk, nj, ni, attributes.shape[1]), np.float32),
    )
    parity = np.zeros((3, nk + 1, nj + 1, ni + 1) if solid else (3, 1, 1, 1), np.uint16)
    scan(
        grid.to_index(vertices),
        vertices,
        faces,
        attributes,
        np.array(grid.wrap),
        voxels.mask,
        voxels.area,
        voxels.normal,
        voxels.attributes,
        parity,
    )
    if solid:
        fill_solid(voxels.mask, parity)
    return voxels


def is_closed(faces: np.ndarray) -> bool:
    """Whether every edge of the mesh is run through equally often in each direction: the condition for an inside."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    forward = edges[:, 0] < edges[:, 1]
    key = np.sort(edges, axis=1)
    _, inverse = np.unique(key, axis=0, return_inverse=True)
    return not np.bincount(inverse.ravel(), weights=np.where(forward, 1, -1)).any()
