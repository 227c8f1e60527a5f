"""Edge-compatible triangular tiles, chosen by a hash: an endless forest from one small atlas.

The plane is cut into equilateral triangles. Each edge has one of two colours, hashed from its place; a triangle
wears the tile of its three edge colours, in one of two variants, hashed from its own place. Nothing is stored,
nothing repeats, and every point is reached directly.

Source: Neyret & Cani 1999 (triangular patterns with edge constraints); Decaudin & Neyret 2004 (texture cells of a
forest).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

RHOMBI = 4
"""The atlas is a torus of 4 x 4 rhombi, two triangles each: 2 orientations x 2 variants x 8 colour triples."""

BOTTOM, LEFT, DIAGONAL = 0, 1, 2
"""Edge directions: along e1, along e2, and from (1, 0) to (0, 1) of a lattice cell."""

EDGES = np.array(
    [
        [[1, 0, 1, 0], [1, 0, 0, 0], [0, 1, 1, 1], [0, 0, 1, 1]],
        [[1, 1, 1, 1], [0, 1, 0, 0], [0, 1, 0, 0], [0, 1, 0, 1]],
        [[1, 1, 0, 1], [1, 0, 0, 0], [1, 1, 0, 1], [1, 0, 0, 0]],
    ],
    np.uint8,
)
"""Colour of the atlas' own edges, [direction, p, q], such that each of the 8 triples of colours occurs exactly twice
among the 16 upward triangles and twice among the 16 downward ones. Found by simulated annealing;
`tests/forest/test_tiles.py` proves
it."""

_MIX = np.array([0x8DA6B343, 0xD8163841, 0xCB1AB31F, 0x165667B1], np.uint32)


def lattice(side: float) -> np.ndarray:
    """The lattice vectors e1 and e2 as rows (2, 2) [m], for triangles of side `side` [m]: x east, y north."""
    return np.array([[side, 0.0], [side / 2, side * np.sqrt(3) / 2]])


def cell_hash(i: np.ndarray, j: np.ndarray, purpose: int | np.ndarray, seed: int) -> np.ndarray:
    """32 random bits of a lattice cell, the same in numpy and GLSL.

    Args:
        i, j: cell numbers, any integers. purpose: 0 to 2 an edge's direction, 3 an upward tile's variant, 4 a
        downward one's. seed: of the map.

    Source: C. Wellons, lowbias32, over a sum of products as in Teschner et al. 2003.
    """
    with np.errstate(over="ignore"):
        parts = [
            np.asarray(value).astype(np.int64).astype(np.uint32) * factor
            for value, factor in zip((i, j, purpose, seed), _MIX, strict=True)
        ]
        x = parts[0] ^ parts[1] ^ parts[2] ^ parts[3]
        x = (x ^ (x >> np.uint32(16))) * np.uint32(0x7FEB352D)
        x = (x ^ (x >> np.uint32(15))) * np.uint32(0x846CA68B)
        return x ^ (x >> np.uint32(16))


def triple(
    p: np.ndarray | int, q: np.ndarray | int, down: np.ndarray | int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Colours (bottom or top, left or right, diagonal) of the atlas' triangle in rhombus (p, q)."""
    p, q, down = np.asarray(p), np.asarray(q), np.asarray(down)
    return (EDGES[BOTTOM, p, (q + down) % RHOMBI], EDGES[LEFT, (p + down) % RHOMBI, q], EDGES[DIAGONAL, p, q])


def tile_table() -> np.ndarray:
    """Rhombus (p, q) of each tile: uint8 [is_down, variant, bottom + 2 left + 4 diagonal, 2]."""
    table = np.zeros((2, 2, 8, 2), np.uint8)
    for down in (0, 1):
        seen = [0] * 8
        for p in range(RHOMBI):
            for q in range(RHOMBI):
                bottom, left, diagonal = triple(p, q, down)
                key = int(bottom) + 2 * int(left) + 4 * int(diagonal)
                table[down, seen[key], key] = p, q
                seen[key] += 1
    return table


@dataclass(frozen=True)
class Place:
    """Where points of the plane fall in the tiling; every field has the points' shape.

    Attributes:
        i, j: lattice cell. down: 1 in a downward triangle. variant: 0 or 1. key: bottom + 2 left + 4 diagonal.
        u, v: atlas coordinate in [0, 1).
    """

    i: np.ndarray
    j: np.ndarray
    down: np.ndarray
    variant: np.ndarray
    key: np.ndarray
    u: np.ndarray
    v: np.ndarray


def locate(xy: np.ndarray, side: float, seed: int) -> Place:
    """The tile and atlas coordinate of points of the plane.

    Args:
        xy: points (..., 2) [m], east and north. side: of the triangles [m]. seed: of the map.

    Source: Neyret & Cani 1999, the tiling; formulas b1, the hash in place of a stored map.
    """
    uv = np.asarray(xy, float) @ np.linalg.inv(lattice(side))
    cell = np.floor(uv)
    fu, fv = np.moveaxis(uv - cell, -1, 0)
    i, j = np.moveaxis(cell.astype(np.int64), -1, 0)
    down = (fu + fv >= 1).astype(np.int64)
    bottom = cell_hash(i, j + down, BOTTOM, seed) & np.uint32(1)
    left = cell_hash(i + down, j, LEFT, seed) & np.uint32(1)
    diagonal = cell_hash(i, j, DIAGONAL, seed) & np.uint32(1)
    variant = (cell_hash(i, j, 3 + down, seed) & np.uint32(1)).astype(np.int64)
    key = (bottom + 2 * left + 4 * diagonal).astype(np.int64)
    p, q = np.moveaxis(tile_table()[down, variant, key], -1, 0).astype(float)
    return Place(i, j, down, variant, key, (p + fu) / RHOMBI, (q + fv) / RHOMBI)
