"""The mask itself, a bit for each direction: 129 are 17 bytes, without loss."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from renderer.directional.codes.code import word_count
from renderer.directional.hemisphere import Hemisphere


@dataclass(frozen=True)
class Bits:
    """Direction i is bit i % 32 of word i // 32.

    Args:
        layout: of the masks.
        blend: whether what lies between directions is blended of the four around it, rather than the nearest one's.
    """

    layout: Hemisphere
    blend: bool = True

    @property
    def size(self) -> int:
        """Bytes."""
        return -(-self.layout.count // 8)

    def encode(self, masks: np.ndarray) -> np.ndarray:
        """As `Code`."""
        packed = np.zeros((len(masks), 4 * word_count(self.size)), np.uint8)
        packed[:, : self.size] = np.packbits(masks, axis=1, bitorder="little")
        return np.asarray(packed.view("<u4"))

    def evaluate(self, words: np.ndarray, places: np.ndarray) -> np.ndarray:
        """As `Code`."""
        return read_cells(self.layout, lambda numbers: bit_of(words, numbers), places, self.blend)


def bit_of(words: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """Bits (M, k) by their numbers (k,) or (M, k)."""
    numbers = np.broadcast_to(numbers, (len(words), numbers.shape[-1]))
    chosen = np.take_along_axis(words, numbers // 32, axis=1)
    return np.asarray((chosen >> (numbers % 32).astype(np.uint32)) & np.uint32(1)).astype(np.float64)


def read_cells(
    layout: Hemisphere, cell: Callable[[np.ndarray], np.ndarray], places: np.ndarray, blend: bool
) -> np.ndarray:
    """Values at places (.., 2) of what `cell` gives for numbers of directions: nearest, or blended of four.

    Between rows the way counts in steps, along a row in parts of it; below the lowest row it is that one.
    """
    rows, azimuths = layout.elevations, layout.azimuths

    def number(row: np.ndarray, turn: np.ndarray) -> np.ndarray:
        return np.asarray(np.where(row >= rows, rows * azimuths, row * azimuths + turn % azimuths))

    height, turn = places[..., 0], places[..., 1]
    if not blend:
        return cell(number(np.floor(height).astype(int), np.floor(turn + 0.5).astype(int)))
    above = np.maximum(height - 0.5, 0)
    row, first = np.floor(above).astype(int), np.floor(turn).astype(int)
    v, u = above - row, turn - first
    low = cell(number(row, first)) * (1 - u) + cell(number(row, first + 1)) * u
    high = cell(number(row + 1, first)) * (1 - u) + cell(number(row + 1, first + 1)) * u
    return np.asarray(low * (1 - v) + high * v)
