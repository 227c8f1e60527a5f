"""Triangle meshes: what the voxeliser, the shells and the references take.

Vertices are metres, z up. A face's front is where its vertices run counter-clockwise. Colours are linear reflectance.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import trimesh

from renderer.core.errors import AssetError, LimitError
from renderer.core.params import Model, param
from renderer.world.limits import DEFAULT_LIMITS, Limits, check_file
from renderer.world.mesh_colour import face_colours
from renderer.world.mesh_formats import parse_mesh

Up = Literal["file", "z", "y"]

MAX_COORDINATE = 1e6
"""Metres from the origin: beyond, float32 on the GPU resolves no leaf. A file in millimetres needs `unit_length`."""

DEFAULT_COLOUR = (0.4, 0.4, 0.4)
"""Linear reflectance of a face whose file says nothing: a mid grey, within what bark and soils reflect."""


class MeshReading(Model):
    """What a mesh file leaves unsaid: which axis is up, and how long its unit is."""

    up: Up = param(
        "file",
        label="Up axis",
        cost="bake",
        help="Which axis of the file is up; file means y for glTF, as its standard says, and z for other formats.",
    )
    unit_length: float = param(
        1.0, label="Length of a unit", help="Metres of one unit of the file.", unit="m", cost="bake", ge=1e-4, le=1e4
    )


@dataclass(frozen=True)
class Mesh:
    """Triangles with colour.

    Args:
        vertices: (V, 3) float64, metres, z up.
        faces: (F, 3) int32, indices of vertices.
        face_colour: (F, 3) float64, linear reflectance in [0, 1].
        vertex_normals: (V, 3) float64 unit vectors as the file gave them, or None.
        two_sided: whether the back of a face is matter too (leaves, open surfaces).
        watertight: whether every edge joins exactly two faces that agree on what is outside.
        notes: what was left out or assumed while reading, in words.
        corner_uv: (F, 3, 2) float64 texture coordinates of the faces' corners, v upwards, or None where the file has
            none.
    """

    vertices: np.ndarray
    faces: np.ndarray
    face_colour: np.ndarray
    vertex_normals: np.ndarray | None = None
    two_sided: bool = False
    watertight: bool = False
    notes: tuple[str, ...] = ()
    corner_uv: np.ndarray | None = None

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of the vertices that faces use, metres."""
        used = self.vertices[self.faces.ravel()]
        return used.min(axis=0), used.max(axis=0)

    def face_normals(self) -> np.ndarray:
        """Unit normals of the faces, (F, 3), towards the side where their vertices run counter-clockwise."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def is_watertight(vertices: np.ndarray, faces: np.ndarray) -> bool:
    """Whether every edge is used once in each direction, vertices at one position counting as one.

    Args:
        vertices: (V, 3). faces: (F, 3).
    """
    _, merged = np.unique(vertices, axis=0, return_inverse=True)
    corners = merged.reshape(-1)[faces].astype(np.int64)
    count = np.int64(len(vertices))
    starts, ends = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    forward, backward = np.sort(starts * count + ends), np.sort(ends * count + starts)
    return bool(len(faces)) and bool((forward[1:] != forward[:-1]).all()) and bool((forward == backward).all())


def load_mesh(path: Path, limits: Limits = DEFAULT_LIMITS, reading: MeshReading | None = None) -> Mesh:
    """Read a mesh from glTF (.glb, or .gltf with everything embedded), OBJ, PLY, STL or OFF; the content decides.

    Nothing outside the file is opened: materials and textures elsewhere are named in `notes` and left out.

    Args:
        path: the file.
        limits: bounds on its size.
        reading: up axis and length of a unit.

    Raises:
        AssetError: naming `file`, `faces`, `vertices`, `uv` or `texture`, in words.
        LimitError: too many bytes, faces, vertices or pixels.
    """
    reading = reading or MeshReading()
    check_file(path, limits)
    parsed = parse_mesh(path.read_bytes(), limits, path.name)
    parts = _instances(parsed.scene, limits)
    colours, notes = [], list(parsed.notes)
    for geometry, _ in parts:
        number = str(getattr(getattr(geometry.visual, "material", None), "name", ""))
        base = parsed.base_colours[int(number)] if number.isdigit() and int(number) < len(parsed.base_colours) else None
        colour, said = face_colours(geometry, base, parsed.format == "gltf", DEFAULT_COLOUR, limits)
        colours.append(colour)
        notes += said
    turn = _frame(reading, parsed.format)
    vertices, faces, normals = _joined(parts, turn)
    uv, said = _texture_coordinates(parts, turn)
    notes += said
    doubled = any(getattr(getattr(g.visual, "material", None), "doubleSided", False) for g, _ in parts)
    return _checked(vertices, faces, np.concatenate(colours), normals, uv, doubled, tuple(dict.fromkeys(notes)))


def _instances(scene: trimesh.Scene, limits: Limits) -> list[tuple[trimesh.Trimesh, np.ndarray]]:
    """Every placed mesh of the scene with faces, and its transform (4, 4); counted before any is copied."""
    parts = []
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        geometry = scene.geometry.get(name)
        if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
            parts.append((geometry, np.asarray(transform, dtype=np.float64)))
    faces, vertices = sum(len(g.faces) for g, _ in parts), sum(len(g.vertices) for g, _ in parts)
    if not faces:
        raise AssetError("faces", "are missing: the file has no triangles", "at least 1")
    if faces > limits.faces:
        raise LimitError("faces", f"number {faces:,}, instances counted each", f"at most {limits.faces:,}")
    if vertices > limits.vertices:
        raise LimitError("vertices", f"number {vertices:,}, instances counted each", f"at most {limits.vertices:,}")
    return parts


def _frame(reading: MeshReading, file_format: str) -> np.ndarray:
    """Matrix (3, 3) from the file's axes and unit to metres with z up."""
    y_up = reading.up == "y" or (reading.up == "file" and file_format == "gltf")
    axes = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]) if y_up else np.eye(3)
    return axes * reading.unit_length


def _joined(
    parts: list[tuple[trimesh.Trimesh, np.ndarray]], turn: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray | None]:
    """One set of vertices (V, 3), faces (F, 3) and, where every part has them, vertex normals (V, 3)."""
    vertices, faces, normals = [], [], []
    start = 0
    for geometry, transform in parts:
        bad = ~np.isfinite(geometry.vertices).all(axis=1)
        if bad.any() or not np.isfinite(transform).all():
            raise AssetError("vertices", f"hold {int(bad.sum()):,} positions that are no numbers", "finite numbers")
        matrix = turn @ transform[:3, :3]
        vertices.append(np.asarray(geometry.vertices, dtype=np.float64) @ matrix.T + turn @ transform[:3, 3])
        corners = np.asarray(geometry.faces, dtype=np.int64)
        if corners.min() < 0 or corners.max() >= len(geometry.vertices):
            raise AssetError("faces", f"name vertex {int(corners.max())} of {len(geometry.vertices):,}")
        faces.append(_front(corners, matrix) + start)
        start += len(geometry.vertices)
        if "vertex_normals" in geometry._cache.cache and abs(np.linalg.det(matrix)) > 0:
            normals.append(np.asarray(geometry.vertex_normals, dtype=np.float64) @ np.linalg.inv(matrix))
    return (
        np.concatenate(vertices),
        np.concatenate(faces),
        np.concatenate(normals) if len(normals) == len(parts) else None,
    )


def _front(corners: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """What holds for the corners of faces (F, 3, ...), in reverse order where a matrix (3, 3) mirrors them."""
    return corners[:, ::-1] if np.linalg.det(matrix) < 0 else corners


def _texture_coordinates(
    parts: list[tuple[trimesh.Trimesh, np.ndarray]], turn: np.ndarray
) -> tuple[np.ndarray | None, tuple[str, ...]]:
    """Texture coordinates (F, 3, 2) of the faces' corners, 0 on parts without; None where no part has any. Notes."""
    found, missing = [], 0
    for geometry, transform in parts:
        uv = getattr(geometry.visual, "uv", None)
        if uv is None or np.shape(uv) != (len(geometry.vertices), 2) or not np.isfinite(uv).all():
            uv, missing = np.zeros((len(geometry.vertices), 2)), missing + 1
        found.append(_front(np.asarray(uv, np.float64)[geometry.faces], turn @ transform[:3, :3]))
    if missing == len(parts):
        return None, ()
    said = (f"{missing:,} of {len(parts):,} parts have no texture coordinates",) if missing else ()
    return np.concatenate(found), said


def _checked(
    vertices: np.ndarray,
    faces: np.ndarray,
    colour: np.ndarray,
    normals: np.ndarray | None,
    uv: np.ndarray | None,
    doubled: bool,
    notes: tuple[str, ...],
) -> Mesh:
    """The mesh, without faces that have no area.

    Raises:
        AssetError: vertices absurdly far away, or no face with an area.
    """
    if np.abs(vertices).max() > MAX_COORDINATE:
        raise AssetError(
            "vertices", f"lie up to {np.abs(vertices).max():g} m from the origin", f"at most {MAX_COORDINATE:g} m"
        )
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    solid = area > 0
    if not solid.any():
        raise AssetError("faces", "have no area", "at least 1 face with an area")
    if not solid.all():
        notes += (f"{int((~solid).sum()):,} faces without area were dropped",)
    faces = faces[solid].astype(np.int32)
    if normals is not None:
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        usable = bool(np.isfinite(length).all() and (length > 0).all())
        normals, notes = (
            (normals / length, notes) if usable else (None, (*notes, "vertex normals without direction were left out"))
        )
    watertight = is_watertight(vertices, faces)
    uv = None if uv is None else uv[solid]
    return Mesh(vertices, faces, colour[solid], normals, doubled or not watertight, watertight, notes, uv)
