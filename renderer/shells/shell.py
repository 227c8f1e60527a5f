"""The shell over a mesh: every triangle a prism, every prism three tetrahedra, each with its map to the texture.

Dufort 2005, sections 3.1 and 3.3. A prism over the triangle A < B < C (numbers of vertices) with the displaced copies
A', B', C' is cut into (A,B,C,C'), (A,B,B',C') and (A,A',B',C'). The rule looks at numbers alone, so neighbours cut the
side that they share along the same diagonal, from the lower bottom vertex to the higher top one, whatever their
position (erratum 002-7). Four corners fix an affine map: no least squares are needed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from renderer.shells.base_mesh import BaseMesh, flat_uv
from renderer.shells.shell_kernels import cells

TOP, BASE, RIM = -1, -2, -3
"""What lies across a tetrahedron's face where no other one does: outside above, the surface, the side of an edge."""

CORNERS = np.array([[0, 1, 2, 5], [0, 1, 4, 5], [0, 3, 4, 5]])
"""Corners of the three tetrahedra among A, B, C, A', B', C'."""

SIGNS = np.array([1.0, -1.0, 1.0])
"""Sign of their determinants where A, B, C run counter-clockwise below A', B', C'."""

SIDES = np.array([[1, 2], [0, 2], [0, 1]])
"""The sides BC, AC and AB of a triangle by corners."""

LOWER = np.array([[0, 0], [0, 1], [1, 3]])
"""Which tetrahedron holds the lower half of each side, and the number of its corner opposite that half."""

UPPER = np.array([[1, 0], [2, 2], [2, 3]])
"""The same for the upper half."""

FLAT = 1e-9
"""Volume over the cube of the longest edge below which a tetrahedron has no inside to speak of."""


@dataclass(frozen=True)
class Edges:
    """What is unusual about the edges of the base mesh, in numbers of edges.

    Args:
        open: belong to one triangle. crowded: belong to three or more. turned: two triangles disagree on their front.
    """

    open: int
    crowded: int
    turned: int


@dataclass(frozen=True)
class Shell:
    """Tetrahedra over a mesh of V vertices and F triangles.

    Args:
        positions: (2V, 3) metres; vertex i of the base, and its displaced copy i + V.
        tets: (3F, 4) int32, vertices in rising order; those of triangle f are 3f, 3f + 1, 3f + 2.
        texture: (3F, 4, 3) coordinates u, v, w of their corners; w is 0 on the base and 1 on the top.
        planes: (3F, 4, 4) planes n.x + d = 0 of the faces opposite each corner, n of unit length, outwards. Two
            tetrahedra that share a face hold the same numbers with opposite signs.
        to_texture: (3F, 3, 4) affine maps from the world to the texture.
        neighbour: (3F, 4) int32, the tetrahedron across the face opposite each corner, or TOP, BASE, RIM.
        signs: (3F,) 1 where a sound cell's corners have a positive determinant in this order, else -1.
        volumes: (3F,) m3, negative where the cell is turned inside out or lies at its triangle's back.
        flat_uv: (N,) int32, triangles whose texture coordinates span no area.
        edges: of the base mesh.
    """

    positions: np.ndarray
    tets: np.ndarray
    texture: np.ndarray
    planes: np.ndarray
    to_texture: np.ndarray
    neighbour: np.ndarray
    signs: np.ndarray
    volumes: np.ndarray
    flat_uv: np.ndarray
    edges: Edges

    def inverted(self) -> np.ndarray:
        """Numbers of the triangles whose prism has a cell that is not on the triangle's front side, (N,)."""
        return np.flatnonzero((self.volumes.reshape(-1, 3) < 0).any(axis=1))

    def flat(self) -> np.ndarray:
        """Numbers of the tetrahedra without an inside, (N,)."""
        return np.flatnonzero(self.volumes == 0)

    @property
    def nbytes(self) -> int:
        """Bytes of all arrays."""
        return sum(value.nbytes for value in vars(self).values() if isinstance(value, np.ndarray))


def build_shell(base: BaseMesh, offset: np.ndarray) -> Shell:
    """The shell between a mesh and its displaced copy.

    Args:
        base: the mesh.
        offset: (V, 3) displacement of each vertex, m.
    """
    count = len(base.vertices)
    order = np.argsort(base.faces, axis=1)
    lower, turn = sorted_faces(base.faces)
    corners = np.concatenate([lower, lower + count], axis=1)
    tets = corners[:, CORNERS].reshape(-1, 4).astype(np.int32)
    uv = np.take_along_axis(base.corner_uv, order[..., None], axis=1)
    uvw = np.concatenate([np.dstack([uv, np.zeros(uv.shape[:2])]), np.dstack([uv, np.ones(uv.shape[:2])])], axis=1)
    texture = uvw[:, CORNERS].reshape(-1, 4, 3)
    neighbour, edges = _neighbours(lower, turn, count)
    positions = np.concatenate([base.vertices, base.vertices + offset])
    planes, to_texture, volumes = cell_geometry(positions, tets, texture)
    signs = (turn[:, None] * SIGNS).ravel()
    return Shell(
        positions, tets, texture, planes, to_texture, neighbour, signs, volumes * signs,
        flat_uv(base.corner_uv).astype(np.int32), edges,
    )


def sorted_faces(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (F, 3) with their vertices in rising order, and 1 where that keeps their turn, else -1, (F,)."""
    order = np.argsort(faces, axis=1)
    # The permutations (0,1,2), (1,2,0) and (2,0,1) keep the turn, the other three reverse it.
    turn = np.where((order[:, 1] - order[:, 0]) % 3 == 1, 1.0, -1.0)
    return np.take_along_axis(faces, order, axis=1), turn


def update_shell(shell: Shell, positions: np.ndarray) -> tuple[Shell, np.ndarray]:
    """The shell with its vertices elsewhere: only tetrahedra that touch a vertex that moved are computed.

    Args:
        shell: what was. positions: (2V, 3) where its vertices are now.

    Returns:
        the new shell, and the numbers of the tetrahedra that changed, (N,).
    """
    moved = (positions != shell.positions).any(axis=1)
    changed = np.flatnonzero(moved[shell.tets].any(axis=1))
    planes, to_texture, volumes = (array.copy() for array in (shell.planes, shell.to_texture, shell.volumes))
    fresh = cell_geometry(positions, shell.tets[changed], shell.texture[changed])
    planes[changed], to_texture[changed] = fresh[:2]
    volumes[changed] = fresh[2] * shell.signs[changed]
    moved_shell = replace(shell, positions=positions, planes=planes, to_texture=to_texture, volumes=volumes)
    return moved_shell, changed


def cell_geometry(
    positions: np.ndarray, tets: np.ndarray, texture: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Planes, maps to the texture and volumes of tetrahedra.

    Args:
        positions: (P, 3) metres. tets: (N, 4) rising vertices. texture: (N, 4, 3).

    Returns:
        planes (N, 4, 4) with normals outwards, maps (N, 3, 4), and volumes (N,) with the sign of the determinant of
        the corners as they stand, 0 for a flat cell. A flat cell's map is its middle, everywhere; a face without
        area has the plane 0.
    """
    planes, to_texture = np.empty((len(tets), 4, 4)), np.empty((len(tets), 3, 4))
    volumes = np.empty(len(tets))
    cells(positions, tets, texture, FLAT, planes, to_texture, volumes)
    return planes, to_texture, volumes


def _neighbours(lower: np.ndarray, turn: np.ndarray, count: int) -> tuple[np.ndarray, Edges]:
    """What lies across each face of each tetrahedron, and what is unusual about the edges.

    Args:
        lower: (F, 3) vertices of the triangles, rising. turn: (F,) 1 where they run counter-clockwise, else -1.
        count: of vertices.
    """
    faces = np.arange(len(lower), dtype=np.int32)
    neighbour = np.full((len(lower), 3, 4), RIM, np.int32)
    neighbour[:, 0, 3], neighbour[:, 2, 0] = BASE, TOP
    neighbour[:, 0, 2], neighbour[:, 1, 2] = 3 * faces + 1, 3 * faces
    neighbour[:, 1, 1], neighbour[:, 2, 1] = 3 * faces + 2, 3 * faces + 1
    key = (lower[:, SIDES[:, 0]].astype(np.int64) * count + lower[:, SIDES[:, 1]]).ravel()
    runs = (turn[:, None] * np.array([1.0, -1.0, 1.0])).ravel()
    # Within an edge, its triangles that run along it stand before those that run against it.
    order = np.lexsort((-runs, key))
    _, start, uses = np.unique(key[order], return_index=True, return_counts=True)
    joined = start[uses > 1]
    one, other = order[joined], order[(start + uses - 1)[uses > 1]]
    for half in (LOWER, UPPER):
        for here, there in ((one, other), (other, one)):
            cell, corner = half[here % 3].T
            neighbour[here // 3, cell, corner] = 3 * (there // 3) + half[there % 3, 0]
    turned = int((runs[one] == runs[other]).sum())
    edges = Edges(open=int((uses == 1).sum()), crowded=int((uses > 2).sum()), turned=turned)
    return neighbour.reshape(-1, 4), edges
