"""Horizon maps resolved for one sun azimuth: the part that the single and the double map share."""

from __future__ import annotations

import math

import numpy as np

from renderer.core.technique import Arrays


def at_azimuth(sectors: np.ndarray, azimuth: float) -> np.ndarray:
    """Horizon elevation at a sun azimuth, linear between the two nearest sector axes.

    Args:
        sectors: horizon elevation [rad], sectors on the first axis, sector k's axis at azimuth 2 pi k / count.
        azimuth: of the sun [rad], clockwise from north.

    Returns:
        The elevation [rad], without the first axis.

    Source: Cohen 2004, section 3.1, Gamma_x(l); the thesis packs the weights in a cube map.
    """
    count = len(sectors)
    place = (azimuth / (2 * math.pi) * count) % count
    first = int(place) % count
    weight = np.float32(place - int(place))
    blended: np.ndarray = sectors[first] * (np.float32(1) - weight) + sectors[(first + 1) % count] * weight
    return blended


def terrain_at(baked: Arrays, azimuth: float) -> np.ndarray:
    """Terrain horizon (N, N) at a sun azimuth, row 0 at the south as textures have it."""
    return np.ascontiguousarray(at_azimuth(baked["sectors"], azimuth)[::-1])
