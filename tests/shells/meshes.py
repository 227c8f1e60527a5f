"""Meshes for the tests of shells: convex, concave, open, closed, and broken in named ways."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from renderer.shells.base_mesh import BaseMesh, from_corners
from renderer.shells.surface_grids import grid_corners, grid_uv, turned
from renderer.shells.surfaces import Mushroom, Plane, Sphere, Teapot, Tube, Vase


def of_faces(vertices: object, faces: object, uv: np.ndarray | None = None) -> BaseMesh:
    """A mesh from lists, its texture the plan from above where none is given."""
    points, triangles = np.asarray(vertices, float), np.asarray(faces)
    plan = points[:, :2] + 0.31 * points[:, 2:] if uv is None else uv
    return from_corners(points[triangles], plan[triangles])


def box(sides: tuple[float, float, float] = (1.0, 0.7, 0.5)) -> BaseMesh:
    x = np.array([[i, j, k] for k in (0, 1) for j in (0, 1) for i in (0, 1)]) * sides
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return of_faces(x, [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))])


def octahedron() -> BaseMesh:
    x = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    return of_faces(x, [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])


def field(height: Callable[[np.ndarray, np.ndarray], np.ndarray], cells: int = 9) -> BaseMesh:
    """A height over a square of side 2."""
    x, y = np.meshgrid(np.linspace(-1, 1, cells + 1), np.linspace(-1, 1, cells + 1))
    nodes = np.stack([x, y, height(x, y)], axis=-1)
    return from_corners(*grid_corners(nodes, grid_uv(cells, cells, 2, 2)))


def torus(ring: float = 0.7, tube: float = 0.25, around: int = 24, across: int = 12) -> BaseMesh:
    turn = 2 * math.pi * (np.arange(across + 1) % across) / across
    profile = np.stack([ring + tube * np.cos(turn), tube * np.sin(turn)], axis=-1)
    return turned(profile, around, 4, np.arange(across + 1) / across)


def lumps(seed: int, size: float, divisions: int = 8) -> BaseMesh:
    """A closed ball with radii drawn by chance."""
    ball = Sphere(radius=1, divisions=divisions).mesh()
    radius = 1 + size * np.random.default_rng(seed).uniform(-1, 1, len(ball.vertices))
    return BaseMesh(ball.vertices * radius[:, None], ball.faces, ball.corner_uv)


def corner() -> BaseMesh:
    """Two squares that meet at a right angle, seen from inside it."""
    x = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (0, 1, 1)]
    return of_faces(x, [(0, 1, 2), (0, 2, 3), (0, 3, 5), (0, 5, 4)])


def fins() -> BaseMesh:
    """Three triangles on one edge."""
    x = [(0, 0, 0), (1, 0, 0), (0.5, 1, 0), (0.5, -0.7, 0.7), (0.5, -0.7, -0.7)]
    return of_faces(x, [(0, 1, 2), (1, 0, 3), (0, 1, 4)])


def moebius(cells: int = 24) -> BaseMesh:
    """A strip with one side: at its seam two triangles disagree on the front."""
    angle = np.linspace(0, 2 * math.pi, cells + 1)
    across = np.array([-0.2, 0.0, 0.2])[:, None]
    radius = 0.8 + across * np.cos(angle / 2)
    nodes = np.stack([radius * np.cos(angle), radius * np.sin(angle), across * np.sin(angle / 2)], axis=-1)
    nodes[:, -1] = nodes[::-1, 0]
    return from_corners(*grid_corners(nodes, grid_uv(2, cells, 4, 1)))


def hourglass() -> BaseMesh:
    """Two triangles that share a vertex alone."""
    return of_faces([(0, 0, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)], [(0, 1, 2), (0, 3, 4)])


def smeared() -> BaseMesh:
    """A plane half of which has all of its texture at one place or on one line."""
    flat = Plane().mesh()
    uv = flat.corner_uv.copy()
    uv[:8] = 0.3
    uv[8:16, :, 1] = 0.5
    return BaseMesh(flat.vertices, flat.faces, uv)


SOUND: dict[str, BaseMesh] = {
    "plane": Plane().mesh(),
    "cube sphere": Sphere().mesh(),
    "globe": Sphere(layout="globe", divisions=4).mesh(),
    "tube": Tube().mesh(),
    "triangle": of_faces([(0, 0, 0), (1, 0.2, 0), (0.1, 1, 0.3)], [(2, 0, 1)]),
    "box": box(),
    "octahedron": octahedron(),
    "bowl": field(lambda x, y: 0.5 * (x**2 + y**2)),
    "saddle": field(lambda x, y: 0.5 * (x**2 - y**2)),
    "waves": field(lambda x, y: 0.1 * np.sin(6 * x) * np.cos(5 * y), 20),
    "torus": torus(),
    "lumps": lumps(1, 0.05),
    "corner": corner(),
    "hourglass": hourglass(),
    "smeared": smeared(),
    "vase": Vase(around=32, along=34).mesh(),
    "mushroom": Mushroom(around=24, along=24).mesh(),
}
"""Meshes whose shell is sound at a small thickness."""

BROKEN: dict[str, BaseMesh] = {
    "teapot": Teapot().mesh(),
    "fins": fins(),
    "moebius": moebius(),
    "spikes": lumps(2, 0.4, 6),
    "thick bowl": field(lambda x, y: 2.0 * (x**2 + y**2)),
    "inward torus": BaseMesh(torus().vertices, torus().faces[:, ::-1].copy(), torus().corner_uv[:, ::-1].copy()),
}
"""Meshes whose shell is broken, or becomes so when it is thick."""

ALL = {**SOUND, **BROKEN}
