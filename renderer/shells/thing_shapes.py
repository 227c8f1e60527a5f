"""Unit shapes of the things beside a shell: their undersides in z = 0, around the origin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from renderer.shells import surface_grids
from renderer.shells.base_mesh import BaseMesh
from renderer.world.mesh_normals import corner_normals

BALL_CELLS = 96
"""Of a ball, around it: its silhouette is at most 0.054 % of the radius inside of the sphere's."""

PROFILE = np.array([
    (0.0, 0.0), (0.82, 0.0), (0.82, 0.1), (0.74, 0.14), (0.6, 0.17), (0.55, 0.22), (0.52, 0.5), (0.55, 0.78),
    (0.62, 0.84), (0.8, 0.88), (1.0, 0.91), (1.0, 1.0), (0.0, 1.0),
])  # fmt: skip
"""Radius and height of a pedestal from the middle of its foot to that of its plate."""


@dataclass(frozen=True)
class Shape:
    """Triangles.

    Attributes:
        corners: (F, 3, 3). normals: (F, 3, 3) unit vectors of the corners. albedo: (F, 3) linear reflectance.
    """

    corners: np.ndarray
    normals: np.ndarray
    albedo: np.ndarray


def shape_of(vertices: np.ndarray, faces: np.ndarray, albedo: np.ndarray | None = None) -> Shape:
    """A mesh as a shape, smooth but for its creases; white where no reflectance (F, 3) is given."""
    white = np.ones((len(faces), 3)) if albedo is None else np.asarray(albedo, np.float64)
    return Shape(vertices[faces], corner_normals(vertices, faces), white)


def _of(made: BaseMesh) -> Shape:
    return shape_of(made.vertices, made.faces)


def box() -> Shape:
    """A cube of side 1."""
    corners = np.stack(np.meshgrid([-0.5, 0.5], [-0.5, 0.5], [0.0, 1.0], indexing="ij"), axis=-1).reshape(-1, 3)
    sides = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    return shape_of(corners, np.concatenate([sides[:, [0, 1, 2]], sides[:, [0, 2, 3]]]))


def ball() -> Shape:
    """A ball of radius 1."""
    turn = np.linspace(-0.5 * np.pi, 0.5 * np.pi, BALL_CELLS // 2 + 1)
    profile = np.stack([np.cos(turn), 1 + np.sin(turn)], axis=-1)
    profile[[0, -1], 0] = 0.0
    corners = _of(surface_grids.turned(profile, BALL_CELLS, 1.0, surface_grids.arc_lengths(profile))).corners
    return Shape(corners, corners - [0, 0, 1], np.ones((len(corners), 3)))


def ground() -> Shape:
    """A level square of side 1."""
    return _of(surface_grids.plane(1.0, 1, 1.0, 1.0))


def pedestal() -> Shape:
    """A pedestal of radius 1 and height 1."""
    return _of(surface_grids.turned(PROFILE, 48, 1.0, surface_grids.arc_lengths(PROFILE)))


SHAPES: dict[str, Callable[[], Shape]] = {"ground": ground, "box": box, "ball": ball, "pedestal": pedestal}
"""Those that need no file, by their kind."""
