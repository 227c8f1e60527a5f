"""A ring of horizons: for each azimuth how many rows of the hemisphere are dark (Max 1988; errata 003-5, formulas d).

Exact wherever what shades a point stands on its horizon without gaps, and cheap to blend; anything that hangs over the
point is taken for a wall below it. Sector s, an equal share of the azimuths, has bits 4 s to 4 s + 3: its dark rows, of
16 rows at most 14, or 15 for all. Behind the last sector, one bit: whether the zenith is lit. 8, 16 or 32 sectors
are 5, 9 or 17 bytes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.directional.codes.code import get, put, word_count, zenith_share
from renderer.directional.hemisphere import Hemisphere

SECTORS = {5: 8, 9: 16, 17: 32}
"""By bytes."""


@dataclass(frozen=True)
class HorizonRing:
    """Dark rows by azimuth, those that misjudge least.

    Args:
        layout: of the masks, at most 16 rows. size: bytes.
    """

    layout: Hemisphere
    size: int = 9

    @property
    def sectors(self) -> int:
        """Of the ring: no more than azimuths."""
        return min(SECTORS[self.size], self.layout.azimuths)

    def encode(self, masks: np.ndarray) -> np.ndarray:
        """As `Code`."""
        rows, across = self.layout.elevations, self.layout.azimuths // self.sectors
        lit = masks[:, :-1].reshape(len(masks), rows, self.sectors, across).sum(axis=3)
        dark = across - lit
        # Of each number of dark rows: lit cells below it, and dark ones from it on.
        none = np.zeros((len(masks), 1, self.sectors), np.int64)
        below = np.concatenate([none, np.cumsum(lit, axis=1)], axis=1)
        above = np.concatenate([np.cumsum(dark[:, ::-1], axis=1)[:, ::-1], none], axis=1)
        wrong = below + above
        if rows > 15:
            wrong[:, 15] = wrong.max() + 1  # its code stands for all rows
        level = np.minimum(wrong.argmin(axis=1), 15)
        words = np.zeros((len(masks), word_count(self.size)), np.uint32)
        for sector in range(self.sectors):
            put(words, 4 * sector, 4, level[:, sector])
        put(words, 4 * self.sectors, 1, masks[:, -1])
        return words

    def evaluate(self, words: np.ndarray, places: np.ndarray) -> np.ndarray:
        """As `Code`: the horizon is blended between the middles of sectors, and half a row on either side of it."""
        places = np.broadcast_to(places, (len(words), *places.shape[-2:]))
        dark = np.stack([get(words, 4 * sector, 4) for sector in range(self.sectors)], axis=1).astype(np.float64)
        dark[dark == 15] = self.layout.elevations
        across = self.layout.azimuths // self.sectors
        turn = (places[..., 1] - (across - 1) / 2) / across
        first = np.floor(turn).astype(int)
        low = np.take_along_axis(dark, first % self.sectors, axis=1)
        high = np.take_along_axis(dark, (first + 1) % self.sectors, axis=1)
        horizon = low + (high - low) * (turn - first)
        ring = np.clip(places[..., 0] - horizon + 0.5, 0, 1)
        share = zenith_share(self.layout, places)
        zenith = get(words, 4 * self.sectors, 1).astype(np.float64)[:, None]
        return np.asarray(ring + (zenith - ring) * share)
