"""What a code of shadow hemispheres is, where directions lie in one, and fields of bits in words."""

from __future__ import annotations

import math
from typing import Protocol

import numpy as np

from renderer.directional.hemisphere import Hemisphere

SIZES = (5, 9, 17, 33)
"""Bytes a point that codes are charted for; nine are the thesis' own."""


class Code(Protocol):
    """Writes masks as words and reads them.

    Attributes:
        layout: directions of the masks.
        size: bytes of a point that hold anything.
    """

    @property
    def layout(self) -> Hemisphere:
        """As above."""

    @property
    def size(self) -> int:
        """As above."""

    def encode(self, masks: np.ndarray) -> np.ndarray:
        """Words (M, W) uint32 of masks (M, count) of booleans, W = ceil(size / 4), unused bits 0."""

    def evaluate(self, words: np.ndarray, places: np.ndarray) -> np.ndarray:
        """Visibilities (M, k) of each point's words (M, W) at places (k, 2) or (M, k, 2), see `places_of`; where the
        code rings, they lie outside of 0 to 1."""


def places_of(layout: Hemisphere, directions: np.ndarray) -> np.ndarray:
    """Places (..., 2) of unit directions (..., 3) at or above the horizon: steps above it, and parts of a row from the
    first axis."""
    height = np.arcsin(np.clip(directions[..., 2], 0, 1)) / layout.step
    turn = np.arctan2(directions[..., 1], directions[..., 0]) / (2 * math.pi) % 1
    return np.stack([height, turn * layout.azimuths], axis=-1)


def cells_of(layout: Hemisphere) -> np.ndarray:
    """Places (count, 2) of a hemisphere's own directions, exactly."""
    rows = np.repeat(np.arange(layout.elevations) + 0.5, layout.azimuths)
    turns = np.tile(np.arange(layout.azimuths, dtype=float), layout.elevations)
    return np.concatenate([np.stack([rows, turns], axis=-1), [[layout.elevations + 0.5, 0.0]]])


def decode(code: Code, words: np.ndarray) -> np.ndarray:
    """What words say of each direction of the layout, (M, count), before any clamp."""
    return code.evaluate(words, cells_of(code.layout))


def judged(code: Code, words: np.ndarray) -> np.ndarray:
    """Masks (M, count) that words stand for: lit where more than half."""
    return decode(code, words) > 0.5


def zenith_share(layout: Hemisphere, places: np.ndarray) -> np.ndarray:
    """How far places (..., 2) are on the way from the last row's middle (0) to the edge of the zenith's cell (1)."""
    return np.asarray(np.clip(2 * (places[..., 0] - layout.elevations + 0.5), 0, 1))


def word_count(size: int) -> int:
    """Words that hold so many bytes."""
    return -(-size // 4)


def put(words: np.ndarray, offset: int, width: int, values: np.ndarray) -> None:
    """Write values (M,) below 2^width at a bit of words (M, W), which must be 0 there; it may cross into the next."""
    wide = values.astype(np.uint64) << np.uint64(offset % 32)
    words[:, offset // 32] |= (wide & np.uint64(0xFFFFFFFF)).astype(np.uint32)
    if offset % 32 + width > 32:
        words[:, offset // 32 + 1] |= (wide >> np.uint64(32)).astype(np.uint32)


def get(words: np.ndarray, offset: int, width: int) -> np.ndarray:
    """Values (M,) uint32 of so many bits, at most 25, at a bit of words (M, W)."""
    wide = words[:, offset // 32].astype(np.uint64)
    if offset % 32 + width > 32:
        wide |= words[:, offset // 32 + 1].astype(np.uint64) << np.uint64(32)
    return ((wide >> np.uint64(offset % 32)) & np.uint64((1 << width) - 1)).astype(np.uint32)
