"""A tree as a mesh, and the two shapes it is made of: tapering tubes of wood and small flat leaves."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

GOLDEN_ANGLE = np.pi * (3 - np.sqrt(5))
"""Divergence between successive branches [rad], as in most plants (Vogel 1979)."""


Part = tuple[np.ndarray, np.ndarray]
"""Vertices (V, 3) [m] and faces (F, 3)."""

Colour = tuple[float, float, float]


@dataclass(frozen=True)
class Tree:
    """A mesh standing at the origin, z up.

    Attributes:
        vertices: (V, 3) [m]. faces: (F, 3), leaves wound so that their normals point out of the crown.
        colour: linear albedo (F, 3). wood: (F,) whether a face is trunk or branch.
    """

    vertices: np.ndarray
    faces: np.ndarray
    colour: np.ndarray
    wood: np.ndarray

    @functools.cached_property
    def height(self) -> float:
        """Highest vertex [m]."""
        return float(self.vertices[:, 2].max())

    @functools.cached_property
    def reach(self) -> float:
        """Farthest that a vertex stands from the foot, horizontally [m]."""
        return float(np.hypot(self.vertices[:, 0], self.vertices[:, 1]).max())

    @functools.cached_property
    def crown_radius(self) -> float:
        """Radius [m] within which 90 % of the leaves stand, seen from above."""
        leaves = self.vertices[self.faces[~self.wood]].mean(axis=1) if not self.wood.all() else self.vertices
        return float(np.quantile(np.hypot(leaves[:, 0], leaves[:, 1]), 0.9))

    def placed(self, scale: float, girth: float, azimuth: float, foot: np.ndarray) -> np.ndarray:
        """Vertices scaled (across by `girth` times as much), turned clockwise by `azimuth` [rad] and moved to `foot`
        (2,) [m]."""
        cos, sin = np.cos(azimuth) * scale * girth, np.sin(azimuth) * scale * girth
        x, y, z = self.vertices.T
        return np.stack([cos * x + sin * y + foot[0], cos * y - sin * x + foot[1], scale * z], axis=1)


@dataclass(frozen=True)
class Species:
    """A kind of tree that the program can grow.

    Attributes:
        name: its file's name. title: for people. source: what the form follows.
        height: range of grown heights [m]. crown: crown radius as a share of the height.
        grow: `(rng, height, crown_radius) -> Tree`, the same for the same generator state.
    """

    name: str
    title: str
    source: str
    height: tuple[float, float]
    crown: float
    grow: Callable[[np.random.Generator, float, float], Tree]

    def sample(self, seed: int, height: float | None = None, crown_radius: float | None = None) -> Tree:
        """Grow one tree; height and crown radius [m] are drawn from the species' own where none are given."""
        rng = np.random.Generator(np.random.PCG64(seed))
        drawn = rng.uniform(*self.height)
        height = drawn if height is None else height
        return self.grow(rng, height, self.crown * height if crown_radius is None else crown_radius)


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) at length one."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)


def tubes(points: np.ndarray, radii: np.ndarray, sides: int) -> tuple[np.ndarray, np.ndarray]:
    """Tapering tubes along polylines.

    Args:
        points: axes (B, n, 3) [m]. radii: (B, n) [m]. sides: corners of the cross-section.

    Returns:
        Vertices (B n sides, 3) and faces, wound outwards.
    """
    count, rings = radii.shape
    tangent = unit(np.gradient(points, axis=1))
    overall = unit(points[:, -1] - points[:, 0])
    # The axis least along the branch never runs parallel to it, so that the frame cannot collapse.
    reference = np.eye(3)[np.argmin(np.abs(overall), axis=1)][:, None, :]
    across = unit(np.cross(tangent, reference))
    other = np.cross(tangent, across)
    angle = np.arange(sides) * (2 * np.pi / sides)
    ring = np.cos(angle)[:, None] * across[:, :, None, :] + np.sin(angle)[:, None] * other[:, :, None, :]
    vertices = (points[:, :, None, :] + radii[:, :, None, None] * ring).reshape(-1, 3)
    first = np.arange(count)[:, None, None] * (rings * sides) + np.arange(rings - 1)[:, None] * sides
    here, there = first + np.arange(sides), first + (np.arange(sides) + 1) % sides
    quads = np.stack([here, there, there + sides, here + sides], axis=-1).reshape(-1, 4)
    return vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def leaves(
    base: np.ndarray, along: np.ndarray, normal: np.ndarray, width: np.ndarray | float
) -> tuple[np.ndarray, np.ndarray]:
    """Flat rhombic leaves, each of two triangles.

    Args:
        base: where they hang (L, 3) [m]. along: from base to tip (L, 3) [m]. normal: side that faces out of the
        crown (L, 3).
        width: full width [m], one number or (L,).
    """
    across = unit(np.cross(normal, along)) * (np.broadcast_to(width, len(base)) / 2)[:, None]
    middle = base + 0.5 * along
    vertices = np.stack([base, middle + across, base + along, middle - across], axis=1).reshape(-1, 3)
    first = 4 * np.arange(len(base))[:, None]
    return vertices, np.concatenate([first + [0, 2, 1], first + [0, 3, 2]])


def join(
    wood: Sequence[Part],
    foliage: Sequence[Part],
    bark: Sequence[Colour],
    green: Colour,
    spread: float,
    rng: np.random.Generator,
) -> Tree:
    """One tree of its parts.

    Args:
        wood, foliage: (vertices, faces) of each part. bark: linear albedo of each wooden part. green: of all leaves.
        spread: standard deviation of the brightness from face to face, as a share.
    """
    parts = [*wood, *foliage]
    firsts = np.cumsum([0] + [len(vertices) for vertices, _ in parts])
    faces = np.concatenate([part + first for (_, part), first in zip(parts, firsts, strict=False)])
    counts = [len(part) for _, part in parts]
    colour = np.repeat(np.array([*bark, *[green] * len(foliage)]), counts, axis=0)
    shade = np.clip(rng.normal(1.0, spread, len(faces)), 1 - 2.5 * spread, 1 + 2.5 * spread)[:, None]
    is_wood = np.repeat(np.arange(len(parts)) < len(wood), counts)
    return Tree(
        np.concatenate([vertices for vertices, _ in parts]),
        faces.astype(np.int64),
        np.clip(colour * shade, 0, 1).astype(np.float32),
        is_wood,
    )


def outwards(
    points: np.ndarray, centre: np.ndarray, rng: np.random.Generator, up: float, disorder: float
) -> np.ndarray:
    """Leaf normals: out of the crown, turned up to the light, and scattered.

    Args:
        points: (L, 3) [m]. centre: of the crown. up: weight of the zenith. disorder: weight of chance.
    """
    normal = unit(unit(points - centre) + np.array([0, 0, up]) + disorder * rng.normal(size=points.shape))
    return normal
