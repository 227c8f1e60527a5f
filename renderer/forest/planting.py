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

GENERATIONS = ((0.84, 1.0, 500), (0.6, 0.84, 600), (0.36, 0.6, 900))
"""Scale of the trees, from old to young, and the darts thrown for each: the small ones find the gaps that the large ones left."""

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
    darts = _Darts(trees, weights, 0.8 / np.sqrt(density), rng)
    strips: dict[tuple[int, int], list[Standing]] = {}
    for direction in (BOTTOM, LEFT, DIAGONAL):
        corners = np.array(_CORNERS[direction]) @ base
        for colour in (0, 1):
            cells = np.argwhere(EDGES[direction] == colour)
            strips[direction, colour] = darts.throw(cells, [], corners, _strip_rule(corners), density)
    planted = [tree for strip in strips.values() for tree in strip]
    for down in (0, 1):
        corners = np.array([(1, 0), (0, 1), (down, down)]) @ base
        for p in range(RHOMBI):
            for q in range(RHOMBI):
                around = []
                for direction, colour, step in zip((BOTTOM, LEFT, DIAGONAL), triple(p, q, down), ((0, down), (down, 0), (0, 0)), strict=True):
                    around += [(tree.foot + np.array(step) @ base, tree.spread) for tree in strips[direction, int(colour)]]
                planted += darts.throw(np.array([[p, q]]), around, corners, _inside_rule(corners), density)
    return planted


def _segment_distance(point: np.ndarray, a: np.ndarray, b: np.ndarray) -> float:
    along = np.clip((point - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return float(np.hypot(*(point - a - along * (b - a))))


def _strip_rule(corners: np.ndarray) -> Callable[[np.ndarray, float], bool]:
    """Whether a crown of some reach belongs to the edge between the first two corners, and to no other."""
    a, b, c, d = corners

    def holds(point: np.ndarray, reach: float) -> bool:
        if _segment_distance(point, a, b) >= reach + MARGIN:
            return False
        return all(_segment_distance(point, *side) >= reach + MARGIN for side in ((a, c), (b, c), (a, d), (b, d)))

    return holds


def _inside_rule(corners: np.ndarray) -> Callable[[np.ndarray, float], bool]:
    """Whether a crown of some reach keeps clear of all three edges."""
    sides = [(corners[n], corners[(n + 1) % 3]) for n in range(3)]
    return lambda point, reach: all(_segment_distance(point, *side) >= reach + MARGIN for side in sides)


class _Darts:
    def __init__(self, trees: Sequence[Tree], weights: np.ndarray, spacing: float, rng: np.random.Generator) -> None:
        self.reach = np.array([tree.reach for tree in trees])
        self.spread = np.array([tree.crown_radius for tree in trees])
        self.weights, self.spacing, self.rng = weights, spacing, rng

    def throw(self, cells: np.ndarray, around: list[tuple[np.ndarray, float]], corners: np.ndarray,
              rule: Callable[[np.ndarray, float], bool], density: float) -> list[Standing]:
        """Plant one region: the triangle of three corners, or the two triangles on either side of the edge between the first two of four."""
        feet, spreads = [foot for foot, _ in around], [spread for _, spread in around]
        planted: list[Standing] = []
        for low, high, darts in GENERATIONS:
            for _ in range(int(darts * len(corners) / 4)):
                point, kind, scale, azimuth = self._dart(corners, low, high)
                reach, spread = scale * self.reach[kind], scale * self.spread[kind]
                if feet:
                    gaps = np.hypot(*(np.array(feet) - point).T) - self.spacing * (np.array(spreads) + spread)
                    if gaps.min() < 0:
                        continue
                if not rule(point, reach):
                    continue
                feet.append(point)
                spreads.append(spread)
                planted.append(Standing(kind, scale, azimuth, point, cells, spread, reach))
        return planted

    def _dart(self, corners: np.ndarray, low: float, high: float) -> tuple[np.ndarray, int, float, float]:
        third = corners[2 + int(self.rng.integers(len(corners) - 2))]
        s, t = self.rng.random(2)
        if s + t > 1:
            s, t = 1 - s, 1 - t
        point = corners[0] + s * (corners[1] - corners[0]) + t * (third - corners[0])
        kind = int(self.rng.choice(len(self.weights), p=self.weights))
        return point, kind, float(self.rng.uniform(low, high)), float(self.rng.uniform(0, 2 * np.pi))
