"""Safe distances of the pattern: how far a ray may jump through air, whatever tile lies next door."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import distance_transform_cdt

from renderer.forest.edge_classes import CORNER, edge_distance, reduce_classes
from renderer.forest.tiles import BOTTOM, DIAGONAL, LEFT, RHOMBI, triple

REACH = 24
"""Largest safe distance [voxels]: beyond it the surroundings are taken for matter."""


def safe_distance(full: np.ndarray) -> np.ndarray:
    """Chebyshev distance [voxels] from each voxel to the nearest matter, over every way to continue the tiling.

    Args:
        full: (K, J, I) whether a voxel of the atlas holds matter.

    Returns:
        uint8 (K, J, I), 0 in matter, at most REACH. Distances are in whole voxels along the grid's own (sheared)
        axes.
    """
    layers, rows, _ = full.shape
    cell = rows // RHOMBI
    place = np.arange(cell)
    upward = place[:, None] + place[None, :] < cell  # the diagonal's own voxels are alike on both sides
    blocks = full.reshape(layers, RHOMBI, cell, RHOMBI, cell).transpose(3, 1, 0, 2, 4)
    anything = [_any_tile(blocks, upward, down) for down in (0, 1)]
    result = np.empty(blocks.shape, np.uint8)
    for p in range(RHOMBI):
        for q in range(RHOMBI):
            for down in (0, 1):
                distance = _distance_in(_surroundings(blocks, p, q, down, upward, anything), cell)
                mine = upward if down == 0 else ~upward
                result[p, q][:, mine] = distance[:, mine]
    whole = result.transpose(2, 1, 3, 0, 4).reshape(full.shape)
    for direction, near in ((BOTTOM, 3.0), (LEFT, 3.0), (DIAGONAL, 3.0), (CORNER, 7.0)):
        # A lookup on the edge itself may fall to either side of it.
        close = np.tile(edge_distance(direction, cell) <= near, (RHOMBI, RHOMBI))
        whole = np.where(close, reduce_classes(whole, direction, np.min), whole)
    return whole


def _any_tile(blocks: np.ndarray, upward: np.ndarray, down: int) -> np.ndarray:
    """Matter in any tile of one orientation, (K, cell, cell), empty in the other half."""
    return blocks.any(axis=(0, 1)) & (~upward if down else upward)


def _surroundings(
    blocks: np.ndarray, p: int, q: int, down: int, upward: np.ndarray, anything: list[np.ndarray]
) -> np.ndarray:
    """Matter in 3 x 3 rhombi around one triangle: its own, what its edges' colours allow beside it, and anything
    beyond."""
    layers, cell = blocks.shape[2], blocks.shape[3]
    patch = np.empty((3, 3, layers, cell, cell), bool)  # [step along j + 1, step along i + 1]
    patch[:] = anything[0] | anything[1]
    mine = ~upward if down else upward
    other = upward if down else ~upward
    steps = {BOTTOM: (1 if down else -1, 0), LEFT: (0, 1 if down else -1), DIAGONAL: (0, 0)}
    for direction, colour in zip((BOTTOM, LEFT, DIAGONAL), triple(p, q, down), strict=True):
        beside = _beside(blocks, direction, int(colour), down) & other
        dj, di = steps[direction]
        kept = blocks[p, q] if direction == DIAGONAL else anything[down]
        patch[1 + dj, 1 + di] = (kept & mine) | beside
    return patch.transpose(2, 0, 3, 1, 4).reshape(layers, 3 * cell, 3 * cell)


def _beside(blocks: np.ndarray, direction: int, colour: int, down: int) -> np.ndarray:
    """Matter of any triangle that may lie across an edge of that colour from a triangle of orientation `down`."""
    other = 1 - down
    p, q = np.meshgrid(np.arange(RHOMBI), np.arange(RHOMBI), indexing="ij")
    return blocks[triple(p, q, other)[direction] == colour].any(axis=0)


def _distance_in(patch: np.ndarray, cell: int) -> np.ndarray:
    """Distances inside the middle rhombus of a patch."""
    reach = min(REACH, cell)
    around = slice(cell - reach, 2 * cell + reach)
    distance = distance_transform_cdt(~patch[:, around, around], metric="chessboard")
    # A patch with no matter at all answers -1: then its rim is all that is known.
    distance = np.where(distance < 0, reach, distance)
    return np.minimum(distance, reach)[:, reach:-reach, reach:-reach].astype(np.uint8)
