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
    (0.0, 0.0), (0.82, 0.0), (0.82, 0.09), (0.79, 0.12), (0.72, 0.145), (0.64, 0.17), (0.58, 0.205), (0.54, 0.26),
    (0.525, 0.34), (0.52, 0.5), (0.525, 0.66), (0.54, 0.74), (0.58, 0.795), (0.65, 0.835), (0.75, 0.865), (0.87, 0.885),
    (1.0, 0.9), (1.0, 1.0), (0.0, 1.0),
])  # fmt: skip
"""Radius and height of a pedestal from the middle of its foot to that of its plate."""


BENT = 0.85
"""Cosine of the angle between two stretches of a profile below which their edge is seen."""


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
    return turned(PROFILE, 64)


def turned(profile: np.ndarray, around: int) -> Shape:
    """A curve turned around the z axis, smooth around it, and along it where it bends by less than `BENT`.

    Args:
        profile: (R + 1, 2) radius and height, its outside to the right. around: cells around the axis.
    """
    step = np.diff(profile, axis=0)
    normal = np.stack([step[:, 1], -step[:, 0]], axis=-1) / np.linalg.norm(step, axis=1, keepdims=True)
    ends = np.stack([normal, normal], axis=1)  # (R, 2, 2), where each stretch begins and ends
    smooth = np.einsum("rk,rk->r", normal[:-1], normal[1:]) > BENT
    middle = normal[:-1] + normal[1:]
    middle /= np.maximum(np.linalg.norm(middle, axis=1, keepdims=True), 1e-9)
    ends[:-1, 1][smooth] = ends[1:, 0][smooth] = middle[smooth]
    angle = 2 * np.pi * np.arange(around + 1) / around
    way = np.stack([np.cos(angle), np.sin(angle)], axis=-1)

    def spun(flat: np.ndarray) -> np.ndarray:
        """(R, 2, 2) ends of stretches as triangles' corners (2 R around, 3, 3)."""
        whole = np.empty((len(flat), 2, around + 1, 3))
        whole[..., :2], whole[..., 2] = flat[:, :, None, :1] * way, flat[:, :, None, 1]
        a, b, c, d = whole[:, 0, :-1], whole[:, 0, 1:], whole[:, 1, 1:], whole[:, 1, :-1]
        return np.stack([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)], axis=2).reshape(-1, 3, 3)

    corners = spun(np.stack([profile[:-1], profile[1:]], axis=1))
    whole = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) > 1e-12
    return Shape(corners[whole], spun(ends)[whole], np.ones((int(whole.sum()), 3)))


SHAPES: dict[str, Callable[[], Shape]] = {"ground": ground, "box": box, "ball": ball, "pedestal": pedestal}
"""Those that need no file, by their kind."""
