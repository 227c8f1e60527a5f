"""The axes of tables over optical depth and cosines, and how they are read: the twin of the fetches in `slab.glsl`."""

from __future__ import annotations

import numpy as np

from renderer.clouds.slab import GRAZING

STEPS = 2
"""Entries for each doubling of the optical depth."""

LEAST, MOST = -6, 8
"""Powers of two of the least and the greatest optical depth in a table. Below the least, what is stored is constant."""

COSINES = 20
"""Cosines in a table: even steps of their square root, dense at grazing."""


def depths() -> np.ndarray:
    """Optical depths of the entries."""
    return 2.0 ** (np.arange((MOST - LEAST) * STEPS + 1) / STEPS + LEAST)


def cosines() -> np.ndarray:
    """Cosines of the entries; the first stands for grazing."""
    return np.maximum((np.arange(COSINES) / (COSINES - 1)) ** 2, GRAZING)


def depth_place(depth: np.ndarray) -> np.ndarray:
    """Fractional entry of optical depths."""
    return np.clip((np.log2(np.maximum(depth, 2.0**LEAST)) - LEAST) * STEPS, 0, (MOST - LEAST) * STEPS)


def cosine_place(mu: np.ndarray) -> np.ndarray:
    """Fractional entry of cosines."""
    return np.clip(np.sqrt(mu), 0, 1) * (COSINES - 1)


def look_up(table: np.ndarray, *places: np.ndarray) -> np.ndarray:
    """A table at fractional entries of its first axes, linearly between entries along each."""
    found = np.zeros(np.broadcast(*places).shape + table.shape[len(places) :])
    lows = [np.minimum(place.astype(int), count - 2) for place, count in zip(places, table.shape)]
    for corner in np.ndindex(*(2,) * len(places)):
        weight = np.ones(np.broadcast(*places).shape)
        for place, low, upper in zip(places, lows, corner):
            weight = weight * (place - low if upper else 1 - (place - low))
        found += (
            weight.reshape(weight.shape + (1,) * (table.ndim - len(places)))
            * table[tuple(low + upper for low, upper in zip(lows, corner))]
        )
    return found
