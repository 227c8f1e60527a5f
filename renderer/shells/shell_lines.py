"""The edges of a shell's tetrahedra as lines, for the view of its cells and conflicts."""

from __future__ import annotations

import numpy as np

BASE_EDGE, TOP_EDGE, UPRIGHT, DIAGONAL = 0, 1, 2, 3
"""Kinds of edges: of the surface, of the shell's top, along an offset, across a side."""

ENDS = np.array([[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]])


def shell_lines(tets: np.ndarray, vertices: int, conflicting: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Every edge of the tetrahedra once.

    Args:
        tets: (3F, 4) of a shell. vertices: V, of its base. conflicting: (N,) prisms in conflict.

    Returns:
        ends (E, 2) int32, lower vertex first; kind (E,) uint8; and whether a prism in conflict has it (E,) bool.
    """
    ends = np.sort(tets[:, ENDS].reshape(-1, 2), axis=1).astype(np.int64)
    marked = np.isin(np.arange(len(tets)) // 3, conflicting)
    key, number = np.unique(ends[:, 0] * (2 * vertices) + ends[:, 1], return_inverse=True)
    found = np.stack([key // (2 * vertices), key % (2 * vertices)], axis=1)
    bad = np.zeros(len(key), bool)
    bad[number.reshape(-1)[np.repeat(marked, 6)]] = True
    low, high = found[:, 0] < vertices, found[:, 1] < vertices
    kind = np.select(
        [high, ~low, found[:, 1] - found[:, 0] == vertices], [BASE_EDGE, TOP_EDGE, UPRIGHT], DIAGONAL
    )
    return found.astype(np.int32), kind.astype(np.uint8), bad
