"""Coarser levels of a 3D texture. Dufort 2005, section 5.3.2; errata 002-4."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LEAST_PASSED = 2.0**-12
"""Transmittance of a voxel's height through what is opaque: keeps a mean of opacities an extinction."""


@dataclass(frozen=True)
class Level:
    """A texture at one resolution.

    Attributes:
        extinction: (K, J, I) [1/m]. colour: (K, J, I, 3) reflectance. normal: (K, J, I, 4) normal and glow.
    """

    extinction: np.ndarray
    colour: np.ndarray
    normal: np.ndarray


def pyramid(finest: Level, height: float) -> list[Level]:
    """Coarser levels, each half as large, to the last that has a voxel.

    Layers are put one over the other, which adds what they absorb; columns side by side, which means their opacities:
    of one voxel's height, as light falls through along w.

    Args:
        finest: level 0. height: of its voxels in the world [m].
    """
    levels = [finest]
    while max(levels[-1].extinction.shape) > 1:
        height *= 2
        levels.append(_coarser(levels[-1], height))
    return levels[1:]


def _coarser(level: Level, height: float) -> Level:
    deep = _pairs(level.extinction, 0)
    opacity = 1 - np.maximum(np.exp(-deep * height), LEAST_PASSED)
    weight = level.extinction[..., None]
    colour = _ratio(_pairs(weight * level.colour, 0), deep)
    normal = _ratio(_pairs(weight * level.normal, 0), deep)
    across = _side_by_side(opacity)
    return Level(
        (-np.log(1 - across) / height).astype(np.float32),
        _ratio(_side_by_side(opacity[..., None] * colour), across),
        _ratio(_side_by_side(opacity[..., None] * normal), across),
    )


def _side_by_side(array: np.ndarray) -> np.ndarray:
    return _pairs(_pairs(array, 1), 2)


def _pairs(array: np.ndarray, axis: int) -> np.ndarray:
    """Mean of neighbours along an axis; a last one without a neighbour is left out, unless it is alone."""
    count = array.shape[axis]
    if count == 1:
        return array
    even = np.take(array, range(0, count - 1, 2), axis)
    odd = np.take(array, range(1, count, 2), axis)
    mean: np.ndarray = (even + odd) / np.float32(2)
    return mean


def _ratio(weighted: np.ndarray, weight: np.ndarray) -> np.ndarray:
    there = weight[..., None] > 0
    return np.divide(weighted, weight[..., None], out=np.zeros(weighted.shape, np.float32), where=there)
