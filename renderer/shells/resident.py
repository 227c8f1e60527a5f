"""The shell and its texture as the GPU holds them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.gl.context import GL
from renderer.gl.meshes import Triangles
from renderer.shells.world_scale import BASE, TET_ROW, TET_TEXELS
from renderer.world.mesh_normals import vertex_normals


@dataclass(frozen=True)
class Placed:
    """Where the shell stands.

    Attributes:
        centre: (3,) middle of its bounding box [m], which everything on the GPU is counted from.
        radius: of the sphere round it that holds the shell [m].
        gradients: (T, 2) lengths of the gradients of u and v in each tetrahedron [1/m]; at rest, where it moves.
        steepest: (S, 2) those of them that no other exceeds in both.
    """

    centre: np.ndarray
    radius: float
    gradients: np.ndarray
    steepest: np.ndarray


def placed(shell: Arrays) -> Placed:
    """The sphere round a shell."""
    positions = shell["positions"]
    centre = (positions.min(axis=0) + positions.max(axis=0)) / 2
    lengths: np.ndarray = np.linalg.norm(shell["to_texture"][:, :2, :3], axis=2)
    return Placed(centre, float(np.sqrt(((positions - centre) ** 2).sum(axis=1).max())), lengths, steepest(lengths))


def steepest(pairs: np.ndarray) -> np.ndarray:
    """(S, 2) of pairs (T, 2), those that no other exceeds in both numbers."""
    falling = pairs[np.lexsort((-pairs[:, 1], -pairs[:, 0]))]
    before = np.maximum.accumulate(np.concatenate([[-np.inf], falling[:-1, 1]]))
    return np.asarray(falling[falling[:, 1] > before])


def tet_texels(shell: Arrays, centre: np.ndarray) -> np.ndarray:
    """(rows, `TET_ROW` * 8, 4) float32 as `shaders/shells/tetrahedra.glsl` reads it."""
    count = len(shell["tets"])
    rows = -(-max(count, 1) // TET_ROW)
    texels = np.zeros((rows * TET_ROW, TET_TEXELS, 4), np.float32)
    planes, maps = shell["planes"], shell["to_texture"]
    texels[:count, :4, :3] = planes[..., :3]
    texels[:count, :4, 3] = planes[..., 3] + planes[..., :3] @ centre
    texels[:count, 4:7, :3] = maps[..., :3]
    texels[:count, 4:7, 3] = maps[..., 3] + maps[..., :3] @ centre
    texels[:count, 7] = shell["neighbour"]
    return texels.reshape(rows, TET_ROW * TET_TEXELS, 4)


def base_texels(shell: Arrays) -> np.ndarray:
    """(rows, `TET_ROW` * 3, 4) float32 as `shaders/shells/base.glsl` reads it: the surface's smooth normals."""
    first, planes = shell["tets"][::3], shell["planes"][::3]
    faces, vertices = first[:, :3].copy(), shell["positions"][: len(shell["positions"]) // 2]
    flat = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    turned = np.einsum("fi,fi->f", flat, planes[:, 3, :3]) > 0  # the shell ends there: its plane looks down
    faces[turned] = faces[turned][:, [0, 2, 1]]
    normals = vertex_normals(vertices, faces)[first[:, :3]]
    away = np.einsum("fki,fki->fk", planes[:, :3, :3], vertices[first[:, :3]]) + planes[:, :3, 3]
    rows = -(-max(len(first), 1) // TET_ROW)
    texels = np.zeros((rows * TET_ROW, 3, 4), np.float32)
    texels[: len(first), :, :3] = normals / np.where(away == 0, np.inf, away)[..., None]
    return texels.reshape(rows, TET_ROW * 3, 4)


def boundary(shell: Arrays, centre: np.ndarray, base: bool) -> tuple[np.ndarray, np.ndarray]:
    """Faces through which rays come into the shell.

    Args:
        centre: taken for the origin [m]. base: whether they may come through the base.

    Returns:
        corners (F, 3, 3) [m], counter-clockwise seen from outside, and 4 tet + face (F,).
    """
    return faces_of(shell, centre, *boundary_faces(shell["neighbour"], base))


def boundary_faces(neighbour: np.ndarray, base: bool) -> tuple[np.ndarray, np.ndarray]:
    """Tetrahedra and faces (F,) beyond which there is none; those on the base where `base` says so."""
    tet, face = np.nonzero((neighbour < 0) & (base | (neighbour != BASE)))
    return tet, face


def faces_of(shell: Arrays, centre: np.ndarray, tet: np.ndarray, face: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners (F, 3, 3) [m] of faces of tetrahedra, counter-clockwise seen from outside of them, and 4 tet + face."""
    others = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])[face]
    corners = shell["positions"][shell["tets"][tet[:, None], others]] - centre
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = np.einsum("fi,fi->f", normal, shell["planes"][tet, face, :3]) < 0
    corners[inward] = corners[inward][:, [0, 2, 1]]
    return corners, 4 * tet + face


def shell_objects(gl: GL, shell: Arrays, place: Placed, base: bool) -> dict[str, Any]:
    """Texture of the tetrahedra, and the triangles through which rays come in."""
    return {
        "shell_tets": gl.texture2d(tet_texels(shell, place.centre), "nearest"),
        "shell_base": gl.texture2d(base_texels(shell), "nearest"),
        "entries": Triangles(gl, *boundary(shell, place.centre, base)),
    }
