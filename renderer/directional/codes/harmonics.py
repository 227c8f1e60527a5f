"""Principal harmonics: the largest of a mask's discrete Fourier transform, quantised (Porquet 2005, section 3.3.2.3).

The annex that fixes his layout is not at hand; this is the reading closest to his words (errata 003-5, formulas d). Of
the 16 x 8 rows, f(a, b) = mean + sum of amplitude cos(2 pi (u a / azimuths + v b / elevations) + phase), each kept
harmonic one cosine. Bits of the words, from the lowest on:

    16 k + 0 .. 5    harmonic k: its number, see `HARMONICS`
    16 k + 6 .. 10   its amplitude: 0 is none, 1 to 31 even steps of the logarithm from LEAST to MOST
    16 k + 11 .. 15  its phase: 32nds of a turn
    16 K + 0 .. 7    mean of the rows: 255ths

With K = 2, 4, 8, 16 harmonics that is 5, 9, 17 or 33 bytes. The zenith takes what the last row says without its
azimuths. Phase counts from the first axis and the lowest row. Rows wrap round in a discrete Fourier transform, so that
the lowest rings with the highest; `codes.cosines` does not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from renderer.directional.codes.code import get, put, word_count, zenith_share
from renderer.directional.hemisphere import Hemisphere


def harmonic(number: int) -> tuple[int, int]:
    """Periods of a harmonic along the azimuth, 0 to 8, and the elevation, -3 to 4, by its number of six bits.

    All that a real 16 x 8 array has but the mean and the finest checkerboard: (u, v) = (number / 8, number % 8), the
    numbers that would be the mean or repeat others being those of u = 8.
    """
    u, v = divmod(number, 8)
    if u == 0 and not 1 <= v <= 4:
        u, v = 8, max(v - 4, 0)
    return u, v if v <= 4 else v - 8


HARMONICS = tuple(harmonic(number) for number in range(64))

MOST = 1 / (8 * math.sin(math.pi / 16))
"""Amplitude of a mask's first harmonic where half of 16 azimuths are lit: no mask has more."""

LEAST = 0.02
"""Smallest amplitude but 0."""

STEP = math.log2(MOST / LEAST) / 30
"""Of the amplitude's code [octaves]."""


@dataclass(frozen=True)
class Harmonics:
    """The largest harmonics of each point's own mask.

    Args:
        layout: of the masks, at least 16 azimuths and 8 rows.
        size: bytes, 1 + 2 a harmonic.
    """

    layout: Hemisphere
    size: int = 9

    @property
    def kept(self) -> int:
        """How many harmonics."""
        return (self.size - 1) // 2

    def encode(self, masks: np.ndarray) -> np.ndarray:
        """As `Code`."""
        words = np.zeros((len(masks), word_count(self.size)), np.uint32)
        basis = self._basis()
        for start in range(0, len(masks), 1 << 15):
            part = slice(start, start + (1 << 15))
            self._encode(masks[part, :-1].astype(np.float32), basis, words[part])
        return words

    def _basis(self) -> np.ndarray:
        """(rows x azimuths, 64) what each harmonic's coefficient counts of a mask, complex."""
        row, turn = np.divmod(np.arange(self.layout.count - 1), self.layout.azimuths)
        u, v = np.array(HARMONICS).T
        angle = 2 * np.pi * (np.outer(turn, u) / self.layout.azimuths + np.outer(row, v) / self.layout.elevations)
        # A harmonic and its mirror image make one cosine, unless they are one.
        own = (2 * u % self.layout.azimuths == 0) & (2 * v % self.layout.elevations == 0)
        return np.asarray(np.exp(-1j * angle) * np.where(own, 1, 2) / len(row), np.complex64)

    def _encode(self, rows: np.ndarray, basis: np.ndarray, words: np.ndarray) -> None:
        found = rows @ basis.real + 1j * (rows @ basis.imag)
        amplitude = np.abs(found)
        largest = np.argsort(-amplitude, axis=1, kind="stable")[:, : self.kept]
        amplitude = np.take_along_axis(amplitude, largest, axis=1)
        phase = np.angle(np.take_along_axis(found, largest, axis=1)) / (2 * np.pi) * 32
        level = np.rint(31 + np.log2(np.maximum(amplitude, 1e-6) / MOST) / STEP)
        level = np.where(amplitude < LEAST / 2, 0, np.clip(level, 1, 31)).astype(np.uint32)
        field = largest.astype(np.uint32) | level << 6 | (np.rint(phase).astype(np.int64) % 32).astype(np.uint32) << 11
        for k in range(self.kept):
            put(words, 16 * k, 16, field[:, k])
        put(words, 16 * self.kept, 8, np.rint(rows.mean(axis=1) * 255))

    def evaluate(self, words: np.ndarray, places: np.ndarray) -> np.ndarray:
        """As `Code`."""
        level = np.clip(places[..., 0] - 0.5, 0, self.layout.elevations - 1) / self.layout.elevations
        turn = places[..., 1] / self.layout.azimuths
        around = 1 - zenith_share(self.layout, places)
        table = np.array(HARMONICS)
        value = (get(words, 16 * self.kept, 8) / 255)[:, None] + np.zeros(places.shape[-2])
        for k in range(self.kept):
            field = get(words, 16 * k, 16)
            amplitude = np.where(field >> 6 & 31, MOST * 2.0 ** (((field >> 6 & 31) - 31.0) * STEP), 0)
            u, v = table[field & 63].T[..., None]
            wave = np.cos(2 * np.pi * (u * turn + v * level + (field >> 11)[:, None] / 32))
            value = value + amplitude[:, None] * wave * np.where(u == 0, 1, around)
        return value


def ringing(raw: np.ndarray) -> tuple[float, float]:
    """How far what a code makes of masks leaves 0 to 1 before it is clamped.

    Args:
        raw: values (M, k).

    Returns:
        Share of the values that do by more than a tenth, and by how much the worst does.
    """
    outside = np.maximum(raw - 1, -raw)
    return float((outside > 0.1).mean()), float(max(outside.max(), 0.0))
