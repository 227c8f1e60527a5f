"""Codes of shadow hemispheres that are measured beside those in use: fixed places for coefficients of a transform.

Errata 003-5 has the first two as L1 and L4. A coefficient has its number of bits by how much it varies over the cloud
(reverse water-filling: Cover & Thomas 2006, section 10.3), in steps that are best for normal distributions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import erfinv

from renderer.directional.codes.code import Code, get, put, word_count
from renderer.directional.hemisphere import Hemisphere

MOST_BITS = 8


@dataclass(frozen=True)
class Transform:
    """Coefficients of an orthonormal basis, each quantised about its mean.

    Args:
        layout: of the masks. size: bytes. basis: (K, count). mean, spread: (K,) of each coefficient over the cloud.
        bits: (K,) of each.
    """

    layout: Hemisphere
    size: int
    basis: np.ndarray
    mean: np.ndarray
    spread: np.ndarray
    bits: np.ndarray

    @cached_property
    def _levels(self) -> list[np.ndarray]:
        """Values that each coefficient can have: middles of equally likely parts of a normal distribution."""
        found = []
        for mean, spread, bits in zip(self.mean, self.spread, self.bits):
            parts = (np.arange(1 << int(bits)) + 0.5) / (1 << int(bits))
            found.append(mean + spread * np.sqrt(2) * erfinv(2 * parts - 1) * 1.15)
        return found

    def encode(self, masks: np.ndarray) -> np.ndarray:
        """As `Code`."""
        words = np.zeros((len(masks), word_count(self.size)), np.uint32)
        offset = 0
        for row, levels, bits in zip(self.basis, self._levels, self.bits):
            edges = (levels[1:] + levels[:-1]) / 2
            put(words, offset, int(bits), np.searchsorted(edges, masks @ row))
            offset += int(bits)
        return words

    def evaluate(self, words: np.ndarray, places: np.ndarray) -> np.ndarray:
        """As `Code`, at the layout's own directions alone."""
        values, offset = np.zeros((len(words), len(self.basis))), 0
        for k, (levels, bits) in enumerate(zip(self._levels, self.bits)):
            values[:, k] = levels[get(words, offset, int(bits))]
            offset += int(bits)
        return np.asarray(values @ self.basis)


def fitted(layout: Hemisphere, size: int, masks: np.ndarray, basis: np.ndarray) -> Transform:
    """Bits where they lessen the error most."""
    found = masks[:: -(-len(masks) // 20_000)] @ basis.T
    mean, spread = found.mean(axis=0), found.std(axis=0)
    left, bits = spread**2, np.zeros(len(basis), int)
    for _ in range(8 * size):
        best = int(np.argmax(np.where(bits < MOST_BITS, left, 0)))
        bits[best] += 1
        left[best] /= 4 if bits[best] > 1 else 2.75  # a first bit leaves 36 % of a normal distribution's variance
    kept = bits > 0
    # What gets no bit keeps its mean.
    constant = (mean * ~kept) @ basis
    rows = [*basis[kept], constant / max(float(np.linalg.norm(constant)), 1e-9)]
    return Transform(
        layout, size, np.array(rows), np.append(mean[kept], np.linalg.norm(constant)), np.append(spread[kept], 0.0),
        np.append(bits[kept], 0),
    )  # fmt: skip


def cosines(layout: Hemisphere) -> np.ndarray:
    """Waves along the azimuth times cosines along the elevation, orthonormal, and the zenith (L4)."""
    around, rows = np.arange(layout.azimuths), np.arange(layout.elevations)
    waves = [np.ones(layout.azimuths)]
    for u in range(1, layout.azimuths // 2):
        angle = 2 * np.pi * u * around / layout.azimuths
        waves += [np.cos(angle), np.sin(angle)]
    waves.append(np.cos(np.pi * around))
    columns = [np.cos(np.pi * v * (rows + 0.5) / layout.elevations) for v in rows]
    flat = [np.append(np.outer(column, wave).ravel(), 0.0) for column in columns for wave in waves]
    flat.append(np.append(np.zeros(layout.count - 1), 1.0))
    return np.array([row / np.linalg.norm(row) for row in flat])


def principal(masks: np.ndarray) -> np.ndarray:
    """Principal components of a cloud's masks, those that vary most first."""
    some = masks[:: -(-len(masks) // 20_000)].astype(np.float64)
    return np.asarray(np.linalg.eigh(np.cov(some.T))[1][:, ::-1].T)


CANDIDATES: dict[str, tuple[tuple[int, ...], Callable[[Hemisphere, int, np.ndarray], Code]]] = {
    "cosines, fixed (L4)": ((5, 9, 17, 33), lambda layout, size, masks: fitted(layout, size, masks, cosines(layout))),
    "principal components": ((5, 9, 17, 33), lambda layout, size, masks: fitted(layout, size, masks, principal(masks))),
}
"""By name: bytes, and what makes one."""
