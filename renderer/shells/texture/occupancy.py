"""Where there is matter: ranges of extinction by brick, and how far a ray may jump through nothing.

Formulas g: minimum and maximum of bricks, and the Chebyshev distance to the nearest filled voxel. From anywhere inside
an empty voxel at distance D a ray may go on until it has crossed D - 1 voxels along any axis.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.ndimage import distance_transform_cdt, maximum_filter, minimum_filter

Wrap = Literal["repeat", "clamp"]

FARTHEST = 31
"""Largest distance that is told apart: as far as a block is padded for what lies across its sides."""


def filled(extinction: np.ndarray, wrap: Wrap, interpolated: bool) -> np.ndarray:
    """Voxels (K, J, I) inside which matter is read.

    Args:
        extinction: (K, J, I), at its densest where it changes.
        wrap: beyond the edges along u and v; along w the last layer goes on.
        interpolated: between voxels' centres, so that a voxel is read up to the middle of each that touches it.
    """
    there = extinction > 0
    if not interpolated:
        return there
    spread: np.ndarray = maximum_filter(there, 3, mode=_modes(wrap))
    return spread


def ranges(extinction: np.ndarray, brick: int, wrap: Wrap, interpolated: bool) -> np.ndarray:
    """Least and greatest extinction read inside each brick, (2, K', J', I') float32.

    Args:
        extinction: (K, J, I). brick: voxels of a side; the last bricks may stick out.
    """
    low = high = extinction
    if interpolated:
        low, high = minimum_filter(low, 3, mode=_modes(wrap)), maximum_filter(high, 3, mode=_modes(wrap))
    starts = [np.arange(0, length, brick) for length in extinction.shape]
    for axis in range(3):
        low = np.minimum.reduceat(low, starts[axis], axis=axis)
        high = np.maximum.reduceat(high, starts[axis], axis=axis)
    return np.stack([low, high]).astype(np.float32)


def distances(occupied: np.ndarray, wrap: Wrap) -> np.ndarray:
    """Chebyshev distance of each voxel to the nearest filled one, (K, J, I) uint8, 0 in it and at most `FARTHEST`.

    Args:
        occupied: as of `filled`. wrap: beyond the edges along u and v; nothing lies beyond those along w.
    """
    if not occupied.any():
        return np.full(occupied.shape, FARTHEST, np.uint8)
    sides = ((0, 0), (FARTHEST, FARTHEST), (FARTHEST, FARTHEST))
    padded = np.pad(occupied, sides, mode="wrap" if wrap == "repeat" else "edge")
    found = distance_transform_cdt(~padded, metric="chessboard")
    inner = found[:, FARTHEST:-FARTHEST, FARTHEST:-FARTHEST]
    return np.minimum(inner, FARTHEST).astype(np.uint8)


def _modes(wrap: Wrap) -> tuple[str, str, str]:
    across = "wrap" if wrap == "repeat" else "nearest"
    return "nearest", across, across
