"""What light makes of each species by itself, in a pattern of which a species map chooses: others may not stand."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.forest.planting import RANKS


def owners(anchor: np.ndarray, ranks: int) -> np.ndarray:
    """Band (...) of the tree that owns each voxel, from the anchors (..., 4) and the ranks of one band."""
    return anchor[..., 3] % RANKS // ranks


def each_alone(
    owner: np.ndarray,
    full: np.ndarray,
    found: Callable[[np.ndarray, Callable[[float], None]], np.ndarray],
    progress: Callable[[float], None],
) -> np.ndarray:
    """A quantity of the voxels, each found among the trees of its own species only.

    Args:
        owner, full: (K, J, I), of each voxel: the band, and whether there is matter.
        found: what (K, J, I), (E, K, J, I) or (K, J, I, C) is found where only the voxels of a mask (K, J, I) are left,
        told whom to tell its progress. progress: told the share done.

    Returns:
        What was found, of the voxel's own species; of air that belongs to none, of the first.
    """
    bands = np.unique(owner[full]) if full.any() else np.zeros(1, int)
    if len(bands) == 1:
        return found(np.ones(owner.shape, bool), progress)
    result = np.empty(0)
    for number, band in enumerate(bands):
        done = number / len(bands)
        part = found(owner == band, lambda share, done=done: progress(done + share / len(bands)))  # type: ignore[misc]
        own = owner == band if part.shape[-3:] == owner.shape else (owner == band)[..., None]
        result = np.where(own, part, result) if number else part
    return result
