"""A user's mesh as a surface for shells, and texture coordinates for meshes that have none."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError, LimitError
from renderer.shells.base_mesh import BaseMesh, from_corners
from renderer.world.mesh import Mesh, MeshReading, load_mesh
from renderer.world.mesh_normals import face_vectors

Mapping = Literal["file", "box", "cylinder", "sphere", "plane"]

MAX_TRIANGLES = 100_000
"""Of a user's mesh: its 300,000 tetrahedra fill 100 MB."""

SAME_PLACE = 1e-7
"""Share of a mesh's extent within which positions are one vertex: files write them with six or seven digits."""


def load_surface(arguments: dict[str, Any]) -> BaseMesh:
    """The mesh of an uploaded file, with texture coordinates.

    Args:
        arguments: the document's `surface` of kind `asset`.

    Raises:
        InputError: `surface.asset` or a field of `surface.reading`, in words.
        LimitError: too many triangles.
    """
    try:
        path = AssetStore().get(arguments["asset"].removeprefix("asset:")).path
        mesh = load_mesh(path, reading=MeshReading.model_validate(arguments["reading"]))
    except InputError as failure:
        inner = f"reading.{failure.field}" if failure.field in MeshReading.model_fields else "asset"
        raise failure.at(f"surface.{inner}") from None
    repeat = np.array([arguments["repeat_u"], arguments["repeat_v"]])
    return surface_of_mesh(mesh, arguments["mapping"], arguments["size"], repeat)


def surface_of_mesh(mesh: Mesh, mapping: Mapping, size: float, repeat: np.ndarray) -> BaseMesh:
    """A mesh as a surface for shells.

    Args:
        mesh: as read.
        mapping: where texture coordinates come from; `file` falls back to `box` where the file has none.
        size: of its longest side, which centres it at the origin, m; 0 keeps it as it is.
        repeat: (2,) factors of u and v.

    Raises:
        LimitError: too many triangles.
    """
    if len(mesh.faces) > MAX_TRIANGLES:
        raise LimitError("surface.asset", f"has {len(mesh.faces):,} triangles", f"at most {MAX_TRIANGLES:,}")
    low, high = mesh.bounds
    corners, notes = mesh.vertices[mesh.faces], mesh.notes
    extent = float((high - low).max())
    if size > 0:
        corners, extent = (corners - (low + high) / 2) * (size / extent), size
    if mapping == "file" and mesh.corner_uv is None:
        mapping, notes = "box", (*notes, "the file has no texture coordinates: they are those of a box")
    uv = mesh.corner_uv if mapping == "file" else None
    if uv is None:
        uv = mapped(corners, mapping)
    return from_corners(corners, uv * repeat, notes, tolerance=SAME_PLACE * extent)


def mapped(corners: np.ndarray, mapping: Mapping) -> np.ndarray:
    """Texture coordinates of triangles by their place alone.

    A box's six sides have the texture by their own directions, 1 along the longest side of all; a plane has it from
    above; a cylinder and a sphere have u by the azimuth around the middle, with v by height or by elevation. Seen
    from the front, the texture of box, cylinder and sphere is not mirrored where the surface looks outwards.

    Args:
        corners: (F, 3, 3) metres.

    Returns:
        (F, 3, 2).
    """
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    across = np.where(high > low, high - low, 1.0)
    if mapping == "plane":
        planned: np.ndarray = (corners - low)[..., :2] / across[:2].max()
        return planned
    if mapping == "box":
        return _boxed((corners - low) / across.max())
    place = corners - (low + high) / 2
    radius = np.hypot(place[..., 0], place[..., 1])
    u = np.arctan2(place[..., 1], place[..., 0]) / (2 * np.pi)
    middle = place.mean(axis=1)
    own = np.arctan2(middle[:, 1], middle[:, 0]) / (2 * np.pi)
    # No azimuth holds on the axis; elsewhere that turn is meant which lies nearest to the triangle's middle.
    axis = radius <= 1e-9 * across.max()
    u = np.where(axis, own[:, None], u + np.round(own[:, None] - u))
    if mapping == "cylinder":
        return np.stack([u, (corners[..., 2] - low[2]) / across[2]], axis=-1)
    return np.stack([u, np.arctan2(place[..., 2], radius) / np.pi + 0.5], axis=-1)


def _boxed(share: np.ndarray) -> np.ndarray:
    """Texture coordinates (F, 3, 2) of places (F, 3, 3), by the side of a box that each triangle looks to."""
    normal = face_vectors(share.reshape(-1, 3), np.arange(3 * len(share)).reshape(-1, 3))
    side = np.abs(normal).argmax(axis=1)
    forward = np.take_along_axis(normal, side[:, None], axis=1)[:, 0] > 0
    right = np.array([1, 0, 0])[side]
    up = np.array([2, 2, 1])[side]
    u = np.take_along_axis(share, right[:, None, None], axis=2)[..., 0]
    v = np.take_along_axis(share, up[:, None, None], axis=2)[..., 0]
    # From +x, y runs to the right; from +y, x runs to the left; from +z, to the right.
    flipped = forward == (side == 1)
    return np.stack([np.where(flipped[:, None], -u, u), v], axis=-1)
