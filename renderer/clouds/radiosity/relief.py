"""What rays of ground and cloud base meet over relief, by Embree: visibility for the transfer matrices."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from embreex import rtcore_scene
from embreex.mesh_construction import TriangleMesh
from scipy.stats import qmc

from renderer.clouds.radiosity.bases import CELL, GRID, HALF
from renderer.core.errors import InputError

Progress = Callable[[float, str], None]

LIFT = 2e-4
"""How far off its surface a ray starts, in heights of the base: above Embree's float32 rounding over the square."""

NOTHING = 2 * GRID * GRID
"""Number of what a ray meets that leaves the square."""

RAYS = 2048
"""Of each cell: 33 000 for each of 256 coefficients."""


@dataclass(frozen=True)
class Hits:
    """What the rays of every cell meet: number of a ground cell, GRID^2 + that of a cloud cell, or `NOTHING`.

    Attributes:
        ground, cloud: (GRID^2, rays) uint16, of rays spread by the cosine over each cell's own slope.
        level_ground, level_cloud: the same of the same rays where all ground is level.
        area: of each ground cell's slope, in squares of the height, (GRID^2,).
    """

    ground: np.ndarray
    cloud: np.ndarray
    level_ground: np.ndarray
    level_cloud: np.ndarray
    area: np.ndarray


def nodes_of(elevation: np.ndarray) -> np.ndarray:
    """Heights of the corners between cells from those of their middles, (N + 1, N + 1)."""
    wide = np.pad(np.asarray(elevation, np.float64), 1, mode="edge")
    return (wide[1:, 1:] + wide[1:, :-1] + wide[:-1, 1:] + wide[:-1, :-1]) / 4


def cast(nodes: np.ndarray, rays: int = RAYS, progress: Progress | None = None, seed: int = 0) -> Hits:
    """Cast every cell's rays.

    Args:
        nodes: heights of the corners of K x K quads over the compute square, in heights of the base, (K + 1, K + 1),
            K a multiple of GRID.
        rays: of each cell, a power of two.
        progress: told the share done; may raise `Cancelled`.
        seed: of each cell's turn of the common points.

    Raises:
        InputError: ground that reaches the base.
    """
    if float(nodes.max()) >= 1 - LIFT:
        raise InputError("elevation", "reaches the cloud base", "less than its height")
    scene, kept = _mesh(nodes)
    sobol = qmc.Sobol(4, scramble=True, rng=np.random.default_rng(7)).random(rays)
    turns = np.random.default_rng(seed).random((2, GRID * GRID, 4))
    ground, cloud, level_ground, level_cloud = (np.empty((GRID * GRID, rays), np.uint16) for _ in range(4))
    for row in range(GRID):
        if progress is not None:
            progress(row / GRID, "rays between ground and clouds")
        cells = slice(row * GRID, (row + 1) * GRID)
        points = (sobol[None] + turns[:, cells, None]) % 1.0
        numbers = np.arange(GRID * GRID)[cells]
        ground[cells] = _from_ground(scene, nodes, numbers, points[0])
        cloud[cells] = _from_cloud(scene, numbers, points[1])
        over = _level(numbers, points[0])
        level_ground[cells] = np.where(over == NOTHING, NOTHING, over + GRID * GRID)
        level_cloud[cells] = _level(numbers, points[1])
    del kept
    return Hits(ground, cloud, level_ground, level_cloud, cell_areas(nodes))


def _mesh(nodes: np.ndarray) -> tuple[rtcore_scene.EmbreeScene, TriangleMesh]:
    count = len(nodes)
    places = np.linspace(-HALF, HALF, count)
    x, y = np.meshgrid(places, places)
    vertices = np.stack([x, y, nodes], axis=-1).reshape(-1, 3).astype(np.float32)
    number = np.arange(count * count).reshape(count, count)
    a, b, c, d = (number[i : count - 1 + i, j : count - 1 + j].ravel() for i, j in ((0, 0), (0, 1), (1, 1), (1, 0)))
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)
    scene = rtcore_scene.EmbreeScene()
    return scene, TriangleMesh(scene, vertices, faces)


def surface(nodes: np.ndarray, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Height and slopes (along x and y) of the triangles at places within the square."""
    count = len(nodes) - 1
    width = 2 * HALF / count
    u, v = (x + HALF) / width, (y + HALF) / width
    j, i = (np.clip(w.astype(int), 0, count - 1) for w in (u, v))
    u, v = u - j, v - i
    a, b, c, d = nodes[i, j], nodes[i, j + 1], nodes[i + 1, j + 1], nodes[i + 1, j]
    first = u >= v  # the triangle a, b, c
    along_x, along_y = np.where(first, b - a, c - d), np.where(first, c - b, d - a)
    return a + u * along_x + v * along_y, along_x / width, along_y / width


def cell_areas(nodes: np.ndarray) -> np.ndarray:
    """Area of the slope within each cell, (GRID^2,)."""
    count = len(nodes) - 1
    width = 2 * HALF / count
    a, b, c, d = nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, 1:], nodes[1:, :-1]
    area = sum(np.sqrt(1 + (p / width) ** 2 + (q / width) ** 2) for p, q in ((b - a, c - b), (c - d, d - a)))
    step = count // GRID
    return (area * width * width / 2).reshape(GRID, step, GRID, step).sum(axis=(1, 3)).ravel()


def _places(cells: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    x = (cells % GRID)[:, None] * CELL - HALF + points[..., 0] * CELL
    y = (cells // GRID)[:, None] * CELL - HALF + points[..., 1] * CELL
    return x, y


def _cosine(points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    sine, angle = np.sqrt(points[..., 2]), 2 * np.pi * points[..., 3]
    return sine * np.cos(angle), sine * np.sin(angle), np.sqrt(np.maximum(1 - points[..., 2], 1e-9))


def _level(cells: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Cell of the plane opposite that each ray meets, all being level."""
    x, y = _places(cells, points)
    u, v, w = _cosine(points)
    return _cell_at(x + u / w, y + v / w)


def _from_ground(
    scene: rtcore_scene.EmbreeScene, nodes: np.ndarray, cells: np.ndarray, points: np.ndarray
) -> np.ndarray:
    x, y = _places(cells, points)
    z, gx, gy = surface(nodes, x, y)
    length = np.sqrt(1 + gx * gx + gy * gy)
    n = np.stack([-gx, -gy, np.ones_like(gx)], axis=-1) / length[..., None]
    u, v, w = _cosine(points)
    p = -1 / (1 + n[..., 2])
    q = n[..., 0] * n[..., 1] * p
    first = np.stack([1 + n[..., 0] ** 2 * p, q, -n[..., 0]], axis=-1)
    second = np.stack([q, 1 + n[..., 1] ** 2 * p, -n[..., 1]], axis=-1)
    way = u[..., None] * first + v[..., None] * second + w[..., None] * n
    origin = np.stack([x, y, z], axis=-1) + LIFT * n
    met, far = _run(scene, origin, way)
    up = np.where(met, far, (1 - origin[..., 2]) / np.where(way[..., 2] > 1e-9, way[..., 2], 1))
    found = _cell_at(origin[..., 0] + up * way[..., 0], origin[..., 1] + up * way[..., 1])
    found = np.where(met | (found == NOTHING), found, found + GRID * GRID)
    return np.where(met | (way[..., 2] > 1e-9), found, NOTHING).astype(np.uint16)


def _from_cloud(scene: rtcore_scene.EmbreeScene, cells: np.ndarray, points: np.ndarray) -> np.ndarray:
    x, y = _places(cells, points)
    u, v, w = _cosine(points)
    origin, way = np.stack([x, y, np.ones_like(x)], axis=-1), np.stack([u, v, -w], axis=-1)
    met, far = _run(scene, origin, way)
    return np.where(met, _cell_at(x + far * u, y + far * v), NOTHING).astype(np.uint16)


def _run(scene: rtcore_scene.EmbreeScene, origin: np.ndarray, way: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    shape = origin.shape[:-1]
    found = scene.run(origin.reshape(-1, 3).astype(np.float32), way.reshape(-1, 3).astype(np.float32), output=True)
    met = found["primID"].reshape(shape) >= 0
    return met, np.where(met, found["tfar"].reshape(shape), 0)


def _cell_at(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    j, i = np.floor((x + HALF) / CELL).astype(int), np.floor((y + HALF) / CELL).astype(int)
    inside = (i >= 0) & (j >= 0) & (i < GRID) & (j < GRID)
    return np.where(inside, i * GRID + j, NOTHING)
