"""The surface where a distance is 0, as triangles: one vertex a cell that it crosses.

Gibson 1998, "Constrained elastic surface nets", without the relaxation: a vertex is the mean of the places at which
the surface crosses its cell's edges.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

BLOCK = 8
"""Nodes along a side of the blocks in which the distance is asked for, or not."""

CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])
EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1])


def surface_nets(
    distance: Callable[[np.ndarray], np.ndarray], low: np.ndarray, high: np.ndarray, cell: float
) -> tuple[np.ndarray, np.ndarray]:
    """Vertices (V, 3) and faces (F, 3), seen from where the distance is positive.

    Args:
        distance: of places (B, P, 3) float32 [m], negative inside; at most as far as the surface is, so that blocks
            which lie farther off than they are wide can be left out.
        low, high: corners of the box, outside of the surface [m]. cell: side of a cell [m].
    """
    counts = np.ceil((high - low) / cell / BLOCK).astype(int)
    corner = np.stack(np.meshgrid(*[np.arange(count) for count in counts], indexing="ij"), axis=-1).reshape(-1, 3)
    middle = low + (corner * BLOCK + (BLOCK - 1) / 2) * cell
    rough = distance(middle[:, None].astype(np.float32))[:, 0]
    near = np.abs(rough) < BLOCK * cell
    inner = np.stack(np.meshgrid(*[np.arange(BLOCK)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    values = np.full((*counts, BLOCK, BLOCK, BLOCK), np.float32(cell))
    values[rough.reshape(counts) < 0] = -cell
    at = corner[near]
    places = (low + (at[:, None] * BLOCK + inner) * cell).astype(np.float32)
    values[at[:, 0], at[:, 1], at[:, 2]] = distance(places).reshape(-1, BLOCK, BLOCK, BLOCK)
    grid = values.transpose(0, 3, 1, 4, 2, 5).reshape(counts * BLOCK)
    inside = grid < 0
    shape = np.array(grid.shape) - 1
    some, every = np.zeros(shape, bool), np.ones(shape, bool)
    for i, j, k in CORNERS:
        part = inside[i : i + shape[0], j : j + shape[1], k : k + shape[2]]
        some |= part
        every &= part
    crossed = np.argwhere(some & ~every)
    number = np.full(shape, -1, np.int32)
    number[tuple(crossed.T)] = np.arange(len(crossed))
    return low + (crossed + _crossings(grid, crossed)) * cell, _quads(inside, number)


def _crossings(grid: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Mean place (C, 3) in [0, 1] at which the surface crosses the edges of cells (C, 3)."""
    at = cells[:, None] + CORNERS
    values = grid[at[..., 0], at[..., 1], at[..., 2]]
    a, b = values[:, EDGES[:, 0]], values[:, EDGES[:, 1]]
    cut = (a < 0) != (b < 0)
    share = np.where(cut, a / np.where(cut, a - b, np.float32(1)), np.float32(0))
    # Where a corner of the edge counts, and how much of the way to its other end.
    fixed, ahead = CORNERS[EDGES[:, 0]], CORNERS[EDGES[:, 1]] - CORNERS[EDGES[:, 0]]
    return np.asarray((cut @ fixed + share @ ahead) / cut.sum(axis=1, keepdims=True))


def _quads(inside: np.ndarray, number: np.ndarray) -> np.ndarray:
    """Two triangles for each edge of the grid that leaves or enters the surface, between the four cells around it."""
    faces = []
    for axis in range(3):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        whole = [slice(1, -1)] * 3
        here, there = list(whole), list(whole)
        here[axis], there[axis] = slice(0, -1), slice(1, None)
        a, b = inside[tuple(here)], inside[tuple(there)]
        at = np.argwhere(a != b) + np.where(np.arange(3) == axis, 0, 1)
        leaving = inside[tuple(at.T)]
        around = []
        for i, j in ((-1, -1), (0, -1), (0, 0), (-1, 0)):
            cell = at.copy()
            cell[:, first] += i
            cell[:, second] += j
            around.append(number[tuple(cell.T)])
        p, q, r, s = around
        quads = np.stack([p, np.where(leaving, q, s), r, np.where(leaving, s, q)], axis=1)
        faces += [quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
    return np.concatenate(faces)
