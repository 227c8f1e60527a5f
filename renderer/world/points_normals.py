"""Normals of a cloud of points: the plane of each point's neighbours, turned the same way all over.

Hoppe, DeRose, Duchamp, McDonald and Stuetzle 1992, "Surface reconstruction from unorganized points", sections 3.2 and
3.3: principal components, and a spanning tree of neighbours whose planes agree, along which the sign is carried.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree
from scipy.spatial import cKDTree

NEIGHBOURS = 12
"""Of a point, itself among them, that its plane is laid through."""

BLOCK = 1 << 17
"""Points whose neighbours are held at once."""


def estimated_normals(
    position: np.ndarray, progress: Callable[[float, str], None]
) -> tuple[np.ndarray, np.ndarray]:
    """Unit normals (N, 3), outwards where the cloud closes, and the distance (N,) [m] to the sixth neighbour.

    Args:
        position: (N, 3) [m].
    """
    tree = cKDTree(position)
    count = min(NEIGHBOURS, len(position))
    normal, away = np.empty((len(position), 3)), np.empty(len(position))
    near = np.empty((len(position), count), np.int32)
    for start in range(0, len(position), BLOCK):
        part = slice(start, start + BLOCK)
        progress(0.6 * start / len(position), "finding normals")
        distance, number = tree.query(position[part], k=count, workers=-1)
        near[part], away[part] = number, distance[:, min(6, count - 1)]
        spread = position[number] - position[number].mean(axis=1, keepdims=True)
        _, vectors = np.linalg.eigh(np.einsum("nki,nkj->nij", spread, spread))
        normal[part] = vectors[:, :, 0]
    progress(0.6, "turning normals outwards")
    return normal * _signs(position, normal, near)[:, None], away


def _signs(position: np.ndarray, normal: np.ndarray, near: np.ndarray) -> np.ndarray:
    """1 or -1 (N,) for each normal: alike along the tree, and upwards at the highest point of each piece."""
    count = len(position)
    start, end = np.repeat(np.arange(count), near.shape[1] - 1), near[:, 1:].reshape(-1).astype(np.int64)
    agree = np.einsum("nk,nk->n", normal[start], normal[end])
    # A weight of 0 would be no edge.
    graph = coo_array((1.001 - np.abs(agree), (start, end)), shape=(count, count)).tocsr()
    tree = minimum_spanning_tree(graph)
    pieces, piece = connected_components(tree, directed=False)
    order = np.lexsort((-position[:, 2], piece))
    tops = order[np.searchsorted(piece[order], np.arange(pieces))]
    sign = np.zeros(count)
    sign[tops] = np.where(normal[tops, 2] < 0, -1.0, 1.0)
    # A point above all pieces, joined to each one's highest, makes one tree of them.
    joined = coo_array((np.ones(pieces), (np.full(pieces, count), tops)), shape=(count + 1, count + 1)).tocsr()
    tree.resize((count + 1, count + 1))
    walked, before = breadth_first_order(joined + tree, count, directed=False)
    parents = before[walked]
    depth = np.zeros(count + 1, np.int64)
    for point, parent in zip(walked[1:].tolist(), parents[1:].tolist()):
        depth[point] = depth[parent] + 1
    levels = np.argsort(depth[walked], kind="stable")
    cuts = np.searchsorted(depth[walked][levels], np.arange(2, depth.max() + 2))
    for first, last in pairwise(cuts):
        here = walked[levels[first:last]]
        there = before[here]
        same = np.einsum("nk,nk->n", normal[here], normal[there]) >= 0
        sign[here] = np.where(same, sign[there], -sign[there])
    return sign
