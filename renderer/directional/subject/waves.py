"""Noise as a sum of plane waves: smooth, without a lattice, the same for the same seed."""

from __future__ import annotations

import numpy as np

WAVES = 16
"""A sum of so many is close to Gaussian."""


def waves(place: np.ndarray, length: float, seed: int) -> np.ndarray:
    """Noise (N,) of mean 0 and standard deviation 1 at places (N, 3), its bumps about `length` wide."""
    rng = np.random.Generator(np.random.PCG64(seed))
    way = rng.normal(size=(WAVES, 3))
    way *= (2 * np.pi / length * rng.uniform(0.6, 1.4, WAVES) / np.linalg.norm(way, axis=1))[:, None]
    total = np.zeros(len(place), np.float32)  # cosines of single precision take a third of the time
    for vector, phase in zip(way, rng.uniform(0, 2 * np.pi, WAVES)):
        total += np.cos((place @ vector + phase).astype(np.float32))
    return np.asarray(total / np.sqrt(WAVES / 2), np.float64)


def octaves(place: np.ndarray, length: float, seed: int, count: int, fall: float = 0.5) -> np.ndarray:
    """Noise of several lengths, each half the last and `fall` times as strong, (N,)."""
    total = np.zeros(len(place))
    for k in range(count):
        total += fall**k * waves(place, length / 2**k, seed + k)
    return total
