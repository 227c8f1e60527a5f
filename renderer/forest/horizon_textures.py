"""Horizons resolved for one sun azimuth: the part that their techniques share."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from renderer.core.technique import Arrays


def sectors_beside(azimuth: float, count: int) -> tuple[int, int, float]:
    """The two sectors whose axes are nearest to an azimuth, and the share of the second.

    Args:
        azimuth: [rad], clockwise from north. count: of sectors; sector k's axis is at azimuth 2 pi k / count.
    """
    place = (azimuth / (2 * math.pi) * count) % count
    first = int(place) % count
    return first, (first + 1) % count, place - int(place)


def at_azimuth(sectors: np.ndarray, azimuth: float) -> np.ndarray:
    """Horizon elevation at a sun azimuth, linear between the two nearest sector axes.

    Args:
        sectors: horizon elevation [rad], sectors on the first axis.
        azimuth: of the sun [rad], clockwise from north.

    Returns:
        The elevation [rad], without the first axis.

    Source: Cohen 2004, section 3.1, Gamma_x(l); the thesis packs the weights in a cube map.
    """
    first, second, share = sectors_beside(azimuth, len(sectors))
    weight = np.float32(share)
    blended: np.ndarray = sectors[first] * (np.float32(1) - weight) + sectors[second] * weight
    return blended


def canopy_at(sectors: np.ndarray, azimuth: float, heights: int) -> np.ndarray:
    """Canopy horizons at a sun azimuth, one channel a height.

    Args:
        sectors: [rad], [heights (of each section, one after the other), chi, J, I]. azimuth: [rad].

    Returns:
        (J, I[, heights]); of several sections (S (J + 2), I[, heights]), as `stacked_at` has heights.
    """
    levels = [at_azimuth(level, azimuth) for level in sectors]
    first = range(0, len(levels), heights)
    each = levels if heights == 1 else [np.stack(levels[n : n + heights], axis=-1) for n in first]
    if len(each) == 1:
        return each[0]
    return np.concatenate([np.concatenate([one[-1:], one, one[:1]]) for one in each])


def terrain_at(baked: Arrays, azimuth: float) -> np.ndarray:
    """Terrain horizon (N, N) at a sun azimuth, row 0 at the south as textures have it."""
    return np.ascontiguousarray(at_azimuth(baked["sectors"], azimuth)[::-1])


@njit(cache=True, nogil=True)
def _stack(first, second, share, result):
    """Blend two sectors (L, J, I, 3) of bytes by 256ths, into (L, J + 2, I, 4)."""
    levels, rows, columns, _ = first.shape
    one, share, half = np.uint32(256 - share), np.uint32(share), np.uint32(128)
    for level in range(levels):
        for j in range(rows + 2):
            a, b = first[level, (j + rows - 1) % rows], second[level, (j + rows - 1) % rows]
            for i in range(columns):
                for channel in range(3):
                    result[level, j, i, channel] = (a[i, channel] * one + b[i, channel] * share + half) >> np.uint32(8)


def stacked_at(soft: np.ndarray, azimuth: float) -> np.ndarray:
    """A soft horizon at a sun azimuth, its heights one above the other in one texture.

    Args:
        soft: uint8 [chi, L, J, I, 3]. azimuth: of the sun [rad].

    Returns:
        uint8 (L (J + 2), I, 4): for each height its rows, the last one again before the first and the first after the
        last, so that no fetch mixes heights; the fourth channel is empty.
    """
    _, levels, rows, columns, _ = soft.shape
    first, second, share = sectors_beside(azimuth, len(soft))
    result = np.zeros((levels, rows + 2, columns, 4), np.uint8)
    _stack(soft[first], soft[second], round(share * 256), result)
    return result.reshape(-1, columns, 4)
