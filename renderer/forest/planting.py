"""Where the trees of the pattern stand: dart throwing that keeps every rule of edge-compatible tiles.

A tree whose crown comes near an edge belongs to that edge's (direction, colour) and stands in every tile that wears
it; all others belong to one triangle and keep clear of its edges. No crown covers a corner. To keep the corners from
showing as a lattice of glades, a few slim trees stand around them, the same at all corners, each crossing one edge
at most.

Source: Neyret & Cani 1999; Cohen 2004, section 2.2 (rules); Cook 1986 (Poisson discs by dart throwing).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from renderer.forest.tiles import BOTTOM, DIAGONAL, EDGES, LEFT, RHOMBI, lattice, triple
from renderer.forest.world_scale import TILE_SIDE, VOXEL
from renderer.world.tree import Tree

MARGIN = 4.5 * VOXEL * np.sqrt(3) / 2
"""Between a crown and any edge that is not its own [m]: four voxels, whose rows stand sin 60 deg apart, and a half
for the snapping."""

GENERATIONS = (((0.84, 1.0), (0.8, 1.0), 600), ((0.66, 0.9), (0.5, 0.7), 700), ((0.4, 0.66), (0.55, 0.85), 500))
"""Height and girth of the trees against their meshes, and the darts thrown: old trees, slender ones that were
crowded, and young ones; the later find the gaps that the earlier left."""

SPACING = 0.88
"""Distance of two stems against the sum of their crown radii: crowns of a closed canopy interlock."""

RANKS = 128
"""Steps in which a stand can be thinned."""

BANDS = 4
"""Species that a species map can tell apart: each has a band of the ranks of its own, in which it is thinned."""

BAND_RANKS = RANKS // BANDS
"""Steps in which one species can be thinned."""

NEARNESS = 0.6
"""Distance of two stems of different species against that of one species, in a pattern from which a species map
chooses: the smaller it is, the denser is what stands alone, and the more of a crown's outside goes to another tree (a
tenth at 0.6)."""

def mixed_share(species: int) -> float:
    """Share of such a pattern's trees that makes a closed stand of all its species, each of which makes one by itself.

    By NEARNESS, crowns of two species cover 1.52 times what they do in a pattern of their mixture, of three 1.88 times.
    """
    return 1 / (1 + 0.47 * (species - 1))


CORNER_RADIUS = 6.0
"""Distance from the corner [m] up to which its own trees stand; the edges' trees begin beyond."""

Rule = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Which of some crowns, by feet (n, 2) [m] and reach (n,) [m], may stand in a region."""

_CORNERS = {
    BOTTOM: ((0, 0), (1, 0), (0, 1), (1, -1)),
    LEFT: ((0, 0), (0, 1), (1, 0), (-1, 1)),
    DIAGONAL: ((1, 0), (0, 1), (0, 0), (1, 1)),
}
"""Lattice points of an edge's two ends and of the two triangles' other corners, from the rhombus that owns the
edge."""


_AROUND = np.array([(0, 1), (-np.sqrt(0.75), -0.5), (np.sqrt(0.75), -0.5)])
"""Corners of a triangle around the origin; twice as large, it holds the unit circle."""


@dataclass(frozen=True)
class Standing:
    """One tree of the pattern.

    Attributes:
        tree: index of its mesh. scale: height against the mesh. girth: width against the height, as a share of the
        mesh's. azimuth: turn [rad]. foot: (2,) [m], from the corner of the rhombus.
        cells: (S, 2) rhombi (p, q) of the atlas in which it stands.
        spread: crown radius [m]. reach: farthest of its vertices from the foot [m].
        kind: its species. rank: 0 to RANKS - 1, in which the stand is thinned from above: see `ranked`.
    """

    tree: int
    scale: float
    girth: float
    azimuth: float
    foot: np.ndarray
    cells: np.ndarray
    spread: float
    reach: float
    kind: int = 0
    rank: int = 0


def plant(
    trees: Sequence[Tree],
    kinds: Sequence[int],
    weights: np.ndarray,
    density: float,
    seed: int,
    nearness: float = 1.0,
) -> list[Standing]:
    """Fill the atlas with trees.

    Args:
        trees: the meshes to choose from. kinds: number of each one's species. weights: their shares of the crowns'
        area (n,), summing to 1.
        density: 1 for a closed canopy; less spaces the crowns out. seed: of places, turns and sizes.
        nearness: distance between two species' stems against that within one.

    Returns:
        The trees, those of the edges first, in an order that is the same around every edge of one colour.
    """
    base = lattice(TILE_SIDE)
    rng = np.random.Generator(np.random.PCG64(seed))
    reach, spread = np.array([tree.reach for tree in trees]), np.array([tree.crown_radius for tree in trees])
    darts = _Darts(reach, spread, np.array(kinds), weights, SPACING / np.sqrt(density), nearness, rng)
    everywhere = np.argwhere(np.ones((RHOMBI, RHOMBI)))
    corner = darts.throw(everywhere, [], 2 * CORNER_RADIUS * _AROUND, _corner_rule(base))
    strips: dict[tuple[int, int], list[Standing]] = {}
    for direction in (BOTTOM, LEFT, DIAGONAL):
        corners = np.array(_CORNERS[direction]) @ base
        for colour in (0, 1):
            cells = np.argwhere(EDGES[direction] == colour)
            strips[direction, colour] = darts.throw(cells, _moved(corner, corners), corners, _strip_rule(corners))
    planted = corner + [tree for strip in strips.values() for tree in strip]
    for down in (0, 1):
        corners = np.array([(1, 0), (0, 1), (down, down)]) @ base
        steps = np.array([(0, down), (down, 0), (0, 0)]) @ base
        for cell in everywhere:
            around = _moved(corner, corners)
            for direction, worn in enumerate(triple(cell[0], cell[1], down)):
                around += _moved(strips[direction, int(worn)], steps[direction : direction + 1])
            planted += darts.throw(cell[None], around, corners, _inside_rule(corners))
    return ranked(planted, base)


def ranked(planted: list[Standing], base: np.ndarray, ranks: int = RANKS) -> list[Standing]:
    """The trees with the ranks in which a thinner stand keeps them: any first share of them stands evenly.

    Each rank goes to the tree that is farthest from those ranked before, over every rhombus where either stands, round
    the torus of the atlas: a progressive sequence, as Eldar et al. 1997 (farthest point strategy) sample pictures.
    """
    if not planted:
        return []
    places = np.concatenate([tree.foot + tree.cells @ base for tree in planted])
    owner = np.repeat(np.arange(len(planted)), [len(tree.cells) for tree in planted])
    away, to_cell = np.full(len(places), np.inf), np.linalg.inv(base)
    result, chosen = np.zeros(len(planted), int), 0
    for number in range(len(planted)):
        result[chosen] = number * ranks // len(planted)
        for place in places[owner == chosen]:
            apart = (places - place) @ to_cell
            apart = (apart - RHOMBI * np.round(apart / RHOMBI)) @ base
            away = np.minimum(away, np.hypot(*apart.T))
        away[owner == chosen] = -1.0
        nearest = np.full(len(planted), np.inf)
        np.minimum.at(nearest, owner, away)
        chosen = int(np.argmax(nearest))
    return [replace(tree, rank=int(rank)) for tree, rank in zip(planted, result, strict=True)]


def banded(planted: list[Standing], bands: Sequence[int]) -> list[Standing]:
    """The trees with ranks in the bands of their species, so that each species by itself is thinned evenly.

    Args:
        planted: the trees. bands: number of each mesh's band, below BANDS.
    """
    base, result = lattice(TILE_SIDE), list(planted)
    for band in sorted(set(bands)):
        own = [number for number, tree in enumerate(planted) if bands[tree.tree] == band]
        for number, tree in zip(own, ranked([planted[n] for n in own], base, BAND_RANKS), strict=True):
            result[number] = replace(tree, rank=band * BAND_RANKS + tree.rank)
    return result


def _moved(trees: list[Standing], places: np.ndarray) -> list[tuple[np.ndarray, float, int]]:
    """Feet, crown radii and species of some trees, at each of some places (n, 2) [m] of their rhombus."""
    return [(tree.foot + place, tree.spread, tree.kind) for tree in trees for place in places]


def _segment_distance(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return np.hypot(*(points - a - along[:, None] * (b - a)).T)


def _corner_rule(base: np.ndarray) -> Rule:
    """Which crowns leave the lattice point free and cross no more than one of the six edges that end there."""
    ends = [sign * side for side in (base[0], base[1], base[1] - base[0]) for sign in (1, -1)]

    def holds(points: np.ndarray, reach: np.ndarray) -> np.ndarray:
        crossed = np.sum([_segment_distance(points, np.zeros(2), end) < reach for end in ends], axis=0)
        result: np.ndarray = (
            (crossed <= 1) & (np.hypot(*points.T) > reach + VOXEL / 2) & (np.hypot(*points.T) < CORNER_RADIUS)
        )
        return result

    return holds


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
    """Throws trees at regions of the plane; `kinds` is the species of each mesh."""

    reach: np.ndarray
    spread: np.ndarray
    kinds: np.ndarray
    weights: np.ndarray
    spacing: float
    nearness: float
    rng: np.random.Generator

    def throw(
        self, cells: np.ndarray, around: list[tuple[np.ndarray, float, int]], corners: np.ndarray, rule: Rule
    ) -> list[Standing]:
        """Plant one region.

        Args:
            cells: rhombi in which it lies. around: feet, crown radii and species of the trees that stand already.
            corners: of the region (n, 2) [m]: triangles of the first two corners with each of the others. rule:
            which crowns it takes.
        """
        feet = np.array([foot for foot, _, _ in around]).reshape(-1, 2)
        spreads = np.array([spread for _, spread, _ in around])
        sorts = np.array([kind for _, _, kind in around], int)
        area = np.zeros(self.kinds.max() + 1)
        share = np.bincount(self.kinds, self.weights, len(area))
        planted: list[Standing] = []
        for heights, girths, darts in GENERATIONS:
            points, tree, scale, girth, azimuth = self._volley(corners, heights, girths, darts * (len(corners) - 2))
            reach, spread = scale * girth * self.reach[tree], scale * girth * self.spread[tree]
            for n in np.flatnonzero(rule(points, reach)):
                kind, crown = self.kinds[tree[n]], spread[n] ** 2
                # Slim species fit where broad ones do not: without a quota they would draw the edges and corners in
                # their own colour.
                if area[kind] > share[kind] * (area.sum() + crown):
                    continue
                apart = self.spacing * np.where(sorts == kind, 1.0, self.nearness)
                gaps = np.hypot(*(feet - points[n]).T) - apart * (spreads + spread[n])
                if gaps.size and gaps.min() < 0:
                    continue
                feet, spreads = np.concatenate([feet, points[n : n + 1]]), np.append(spreads, spread[n])
                sorts = np.append(sorts, kind)
                area[kind] += crown
                planted.append(
                    Standing(
                        int(tree[n]),
                        float(scale[n]),
                        float(girth[n]),
                        float(azimuth[n]),
                        points[n],
                        cells,
                        float(spread[n]),
                        float(reach[n]),
                        int(kind),
                    )
                )
        return planted

    def _volley(
        self, corners: np.ndarray, heights: tuple[float, float], girths: tuple[float, float], count: int
    ) -> tuple[np.ndarray, ...]:
        """Points over the region, with the number of a mesh, its height and girth, and its turn."""
        third = corners[2 + self.rng.integers(len(corners) - 2, size=count)]
        s, t = self.rng.random((2, count, 1))
        s, t = np.where(s + t > 1, 1 - s, s), np.where(s + t > 1, 1 - t, t)
        points = corners[0] + s * (corners[1] - corners[0]) + t * (third - corners[0])
        return (
            points,
            self.rng.choice(len(self.weights), size=count, p=self.weights),
            self.rng.uniform(*heights, count),
            self.rng.uniform(*girths, count),
            self.rng.uniform(0, 2 * np.pi, count),
        )
