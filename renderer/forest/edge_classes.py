"""What all edges of one direction and colour share in the atlas: the means and minima that keep tiles seamless."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.forest.tiles import BOTTOM, DIAGONAL, EDGES, LEFT, RHOMBI

CORNER = 3
"""Beside the three edge directions: the lattice points, which are all alike."""


def edge_distance(direction: int, cell: int) -> np.ndarray:
    """Distance of each voxel of a rhombus to the nearest edge of a direction, in rows of voxels.

    Args:
        direction: BOTTOM, LEFT, DIAGONAL, or CORNER for the distance to the lattice points (largest of the three to
        the lines through it).
        cell: voxels a side of a rhombus.

    Returns:
        (cell, cell) [j, i].
    """
    place = np.arange(cell) + 0.5
    i, j = np.meshgrid(place, place)
    to_line = [np.minimum(j, cell - j), np.minimum(i, cell - i), np.abs(i + j - cell)]
    if direction != CORNER:
        distance: np.ndarray = to_line[direction]
        return distance
    candidates = []
    for ci, cj in ((0, 0), (cell, 0), (0, cell), (cell, cell)):
        di, dj = i - ci, j - cj
        candidates.append(np.maximum(np.maximum(np.abs(di), np.abs(dj)), np.abs(di + dj)))
    return np.min(candidates, axis=0)


def reduce_classes(volume: np.ndarray, direction: int, operation: Callable[..., np.ndarray]) -> np.ndarray:
    """Replace the surroundings of every edge by one reduction over all edges of its direction and colour.

    Args:
        volume: (K, J, I) over the whole atlas. direction: as for `edge_distance`. operation: `np.mean`, `np.min` or
        `np.max`, with `axis`.

    Returns:
        Like `volume`; meaningful within half a rhombus of the edges in question.
    """
    layers, rows, columns = volume.shape
    cell = rows // RHOMBI
    half = (cell // 2 if direction in (BOTTOM, CORNER) else 0, cell // 2 if direction in (LEFT, CORNER) else 0)
    moved = np.roll(volume, half, axis=(1, 2))
    blocks = moved.reshape(layers, RHOMBI, cell, RHOMBI, cell).transpose(3, 1, 0, 2, 4)  # [p, q, k, j, i]
    result = np.empty_like(blocks)
    colours = EDGES[direction] if direction != CORNER else np.zeros((RHOMBI, RHOMBI), np.uint8)
    for colour in np.unique(colours):
        result[colours == colour] = operation(blocks[colours == colour], axis=0)
    whole = result.transpose(2, 1, 3, 0, 4).reshape(layers, rows, columns)
    return np.roll(whole, (-half[0], -half[1]), axis=(1, 2))


def blend_edges(volume: np.ndarray, inner: float, outer: float) -> np.ndarray:
    """Make a quantity that depends on its wide surroundings the same around all edges of one class.

    Args:
        volume: (K, J, I) float. inner: rows of voxels from an edge within which the class mean stands alone. outer:
        where it fades out.

    Returns:
        The blended volume. Where two edges are both near, at the corners, the mean over all corners stands.
    """
    cell = volume.shape[1] // RHOMBI
    edges = [_fade(edge_distance(direction, cell), inner, outer) for direction in (BOTTOM, LEFT, DIAGONAL)]
    # Two edges can both be within `inner` only as far as twice that from the corner.
    corner = _fade(edge_distance(CORNER, cell), 2 * inner + 1, 2 * outer + 1)
    own = np.prod([1 - w for w in edges], axis=0)
    shares = [w * np.prod([1 - other for n, other in enumerate(edges) if n != m], axis=0) for m, w in enumerate(edges)]
    total = np.maximum(own + sum(shares), 1e-9)
    tiled = [np.tile((1 - corner) * share / total, (RHOMBI, RHOMBI)) for share in (own, *shares)]
    result = tiled[0] * volume
    for direction, weight in zip((BOTTOM, LEFT, DIAGONAL), tiled[1:], strict=True):
        result = result + weight * reduce_classes(volume, direction, np.mean)
    return (result + np.tile(corner, (RHOMBI, RHOMBI)) * reduce_classes(volume, CORNER, np.mean)).astype(volume.dtype)


def _fade(distance: np.ndarray, inner: float, outer: float) -> np.ndarray:
    t = np.clip((outer - distance) / (outer - inner), 0, 1)
    return t * t * (3 - 2 * t)
