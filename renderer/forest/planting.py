"""Where the trees of the pattern stand: dart throwing that keeps every rule of edge-compatible tiles.

A tree whose crown comes near an edge belongs to that edge's (direction, colour) and stands in every tile that wears it; all others belong to
one triangle and keep clear of its edges. No crown comes near two edges, so none covers a corner.

Source: Neyret & Cani 1999; Cohen 2004, section 2.2 (rules); Cook 1986 (Poisson discs by dart throwing).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from renderer.forest.tiles import BOTTOM, DIAGONAL, EDGES, LEFT, RHOMBI, lattice, triple
from renderer.forest.tree import Tree
from renderer.forest.world_scale import TILE_SIDE, VOXEL

MARGIN = 4.5 * VOXEL * np.sqrt(3) / 2
"""Between a crown and any edge that is not its own [m]: four voxels, whose rows stand sin 60 deg apart, and a half for the snapping."""

GENERATIONS = ((0.84, 1.0, 400), (0.6, 0.84, 400), (0.36, 0.6, 500))
"""Scale of the trees, from old to young, and the darts thrown for each: the small ones find the gaps that the large ones left."""

SPACING = 0.8
"""Distance of two stems against the sum of their crown radii: crowns of a closed canopy interlock."""

Rule = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Which of some crowns, by feet (n, 2) [m] and reach (n,) [m], may stand in a region."""

_CORNERS = {BOTTOM: ((0, 0), (1, 0), (0, 1), (1, -1)), LEFT: ((0, 0), (0, 1), (1, 0), (-1, 1)), DIAGONAL: ((1, 0), (0, 1), (0, 0), (1, 1))}
"""Lattice points of an edge's two ends and of the two triangles' other corners, from the rhombus that owns the edge."""


@dataclass(frozen=True)
class Standing:
    """One tree of the pattern.

    Attributes:
        tree: index of its mesh. scale: against the mesh. azimuth: turn [rad]. foot: (2,) [m], from the corner of the rhombus.
        cells: (S, 2) rhombi (p, q) of the atlas in which it stands.
        spread: crown radius [m]. reach: farthest of its vertices from the foot [m].
    """

    tree: int
    scale: float
    azimuth: float
    foot: np.ndarray
    cells: np.ndarray
    spread: float
    reach: float


def plant(trees: Sequence[Tree], weights: np.ndarray, density: float, seed: int) -> list[Standing]:
    """Fill the atlas with trees.

    Args:
        trees: the meshes to choose from. weights: their shares (n,), summing to 1.
        density: 1 for a closed canopy; less spaces the crowns out. seed: of places, turns and sizes.

    Returns:
        The trees, those of the edges first, in an order that is the same around every edge of one colour.
    """
    rng = np.random.Generator(np.random.PCG64(seed))
    base = lattice(TILE_SIDE)
    darts = _Darts(np.array([tree.reach for tree in trees]), np.array([tree.crown_radius for tree in trees]), weights,
                   SPACING / np.sqrt(density), rng)
    strips: dict[tuple[int, int], list[Standing]] = {}
    for direction in (BOTTOM, LEFT, DIAGONAL):
        corners = np.array(_CORNERS[direction]) @ base
        for colour in (0, 1):
            cells = np.argwhere(EDGES[direction] == colour)
            strips[direction, colour] = darts.throw(cells, [], corners, _strip_rule(corners))
    planted = [tree for strip in strips.values() for tree in strip]
    for down in (0, 1):
        corners = np.array([(1, 0), (0, 1), (down, down)]) @ base
        for p in range(RHOMBI):
            for q in range(RHOMBI):
                around = []
                for direction, colour, step in zip((BOTTOM, LEFT, DIAGONAL), triple(p, q, down), ((0, down), (down, 0), (0, 0)), strict=True):
                    around += [(tree.foot + np.array(step) @ base, tree.spread) for tree in strips[direction, int(colour)]]
                planted += darts.throw(np.array([[p, q]]), around, corners, _inside_rule(corners))
    return planted


def _segment_distance(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return np.hypot(*(points - a - along[:, None] * (b - a)).T)


def _strip_rule(corners: np.ndarray) -> Rule:
    """Which crowns belong to the edge between the first two corners, and to no other."""
    a, b, c, d = corners

    def holds(points: np.ndarray, reach: np.ndarray) -> np.ndarray:
        own = _segment_distance(points, a, b) < reach + MARGIN
        return own & _clear_of([(a, c), (b, c), (a, d), (b, d)], points, reach)

    return holds


def _inside_rule(corners: np.ndarray) -> Rule:
    """Which crowns keep clear of all three edges."""
    sides = [(corners[n], corners[(n + 1) % 3]) for n in range(3)]
    return lambda points, reach: _clear_of(sides, points, reach)


def _clear_of(sides: list[tuple[np.ndarray, np.ndarray]], points: np.ndarray, reach: np.ndarray) -> np.ndarray:
    clear: np.ndarray = np.min([_segment_distance(points, *side) for side in sides], axis=0) >= reach + MARGIN
    return clear


@dataclass(frozen=True)
class _Darts:
    """Throws trees at regions of the plane."""

    reach: np.ndarray
    spread: np.ndarray
    weights: np.ndarray
    spacing: float
    rng: np.random.Generator

    def throw(self, cells: np.ndarray, around: list[tuple[np.ndarray, float]], corners: np.ndarray, rule: Rule) -> list[Standing]:
        """Plant one region: the triangle of three corners, or both triangles beside the edge of the first two of four."""
        feet = np.array([foot for foot, _ in around]).reshape(-1, 2)
        spreads = np.array([spread for _, spread in around])
        planted: list[Standing] = []
        for low, high, darts in GENERATIONS:
            points, kinds, scales, azimuths = self._volley(corners, low, high, darts * (len(corners) - 2))
            reach, spread = scales * self.reach[kinds], scales * self.spread[kinds]
            for n in np.flatnonzero(rule(points, reach)):
                gaps = np.hypot(*(feet - points[n]).T) - self.spacing * (spreads + spread[n])
                if gaps.size and gaps.min() < 0:
                    continue
                feet, spreads = np.concatenate([feet, points[n : n + 1]]), np.append(spreads, spread[n])
                planted.append(Standing(int(kinds[n]), float(scales[n]), float(azimuths[n]), points[n], cells,
                                        float(spread[n]), float(reach[n])))
        return planted

    def _volley(self, corners: np.ndarray, low: float, high: float, count: int) -> tuple[np.ndarray, ...]:
        """Points over the region, with the number of a mesh, its scale and its turn."""
        third = corners[2 + self.rng.integers(len(corners) - 2, size=count)]
        s, t = self.rng.random((2, count, 1))
        s, t = np.where(s + t > 1, 1 - s, s), np.where(s + t > 1, 1 - t, t)
        points = corners[0] + s * (corners[1] - corners[0]) + t * (third - corners[0])
        return (points, self.rng.choice(len(self.weights), size=count, p=self.weights), self.rng.uniform(low, high, count),
                self.rng.uniform(0, 2 * np.pi, count))
