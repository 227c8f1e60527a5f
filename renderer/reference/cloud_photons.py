"""What photons in a cloud do: a free path, a new direction drawn from a tabulated phase function.

Shared by the plane slab and the spherical shell. Each block of photons has a generator of its own (SplitMix64:
Steele, Lea & Flood 2014), so that results depend on the seed alone and not on the number of threads.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit

GUIDES = 8192
"""Entries of the table that says where in the cumulative distribution a search begins."""

ORDERS = 4
"""Orders told apart: 0, 1, 2, and 3 or more."""

BLOCK = 20_000
"""Photons a seed."""


@dataclass(frozen=True)
class Scatterer:
    """A phase function ready to be drawn from: linear in the cosine between its entries.

    Attributes:
        cosine: (M,) rising from -1 to 1. density: (M,) over the cosine, integral 1. below: (M,) cumulative.
        guide: (GUIDES,) last entry of `below` no greater than the guide's own level.
    """

    cosine: np.ndarray
    density: np.ndarray
    below: np.ndarray
    guide: np.ndarray

    @staticmethod
    def of(angles: np.ndarray, values: np.ndarray) -> Scatterer:
        """From a phase function's values [1/sr, or any unit] at angles [rad] rising from 0 to pi."""
        cosine = np.cos(np.asarray(angles, np.float64))[::-1].copy()
        cosine[0], cosine[-1] = -1.0, 1.0
        density = np.asarray(values, np.float64)[::-1].copy()
        steps = np.diff(cosine) * (density[1:] + density[:-1]) / 2
        whole = steps.sum()
        below = np.concatenate([[0.0], np.cumsum(steps) / whole])
        guide = np.searchsorted(below, np.arange(GUIDES) / GUIDES, side="right") - 1
        return Scatterer(cosine, density / whole, below, np.minimum(guide, len(cosine) - 2))

    def tables(self) -> tuple[np.ndarray, ...]:
        """What the compiled functions take."""
        return self.cosine, self.density, self.below, self.guide


@njit(cache=True, nogil=True)
def draw_cosine(u: float, cosine: np.ndarray, density: np.ndarray, below: np.ndarray, guide: np.ndarray) -> float:
    """The scattering angle's cosine below which the share u of all falls."""
    low = guide[int(u * len(guide))]
    while below[low + 1] < u:
        low += 1
    wanted = u - below[low]
    width = cosine[low + 1] - cosine[low]
    first, slope = density[low], (density[low + 1] - density[low]) / width
    # Root of first x + slope x^2 / 2 = wanted, in the form that does not cancel.
    root = math.sqrt(max(first * first + 2.0 * slope * wanted, 0.0))
    return cosine[low] + min(2.0 * wanted / max(first + root, 1e-300), width)


@njit(cache=True, nogil=True)
def uniform(state: np.ndarray) -> float:
    """The next draw from [0, 1); `state` (1,) uint64 moves on."""
    state[0] += np.uint64(0x9E3779B97F4A7C15)
    mixed = state[0]
    mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    mixed ^= mixed >> np.uint64(31)
    return float(mixed >> np.uint64(11)) / 9007199254740992.0


@njit(cache=True, nogil=True)
def turned(x: float, y: float, z: float, cosine: float, state: np.ndarray) -> tuple[float, float, float]:
    """A unit vector turned by an angle of that cosine, at a random azimuth."""
    azimuth = 2.0 * math.pi * uniform(state)
    sine = math.sqrt(max(1.0 - cosine * cosine, 0.0))
    a, b = sine * math.cos(azimuth), sine * math.sin(azimuth)
    across = math.sqrt(x * x + y * y)
    if across < 1e-9:
        return a, b, cosine if z > 0.0 else -cosine
    tx = cosine * x + (a * x * z - b * y) / across
    ty = cosine * y + (a * y * z + b * x) / across
    tz = cosine * z - a * across
    size = 1.0 / math.sqrt(tx * tx + ty * ty + tz * tz)
    return tx * size, ty * size, tz * size


def in_blocks(trace: Any, photons: int, seed: int, threads: int) -> list[Any]:
    """`trace(state of the block's generator, photons of the block)` for every block, on so many threads, in order."""
    count = max(-(-photons // BLOCK), 1)
    seeds = [child.generate_state(1, np.uint64) for child in np.random.SeedSequence(seed).spawn(count)]
    sizes = [min(BLOCK, photons - BLOCK * number) for number in range(count)]
    with ThreadPoolExecutor(max_workers=max(threads, 1)) as pool:
        return list(pool.map(trace, seeds, sizes))
