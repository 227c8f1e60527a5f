"""The mask itself, a bit for each direction: 129 are 17 bytes, without loss."""

from __future__ import annotations

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
        sharpness: slope of what is shown of a blend, about its middle (Green 2007); 1 leaves it as it is.
    """

    layout: Hemisphere
    blend: bool = True
    sharpness: float = 1.0

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
        octets = np.ascontiguousarray(words).view(np.uint8)
        masks = np.unpackbits(octets, axis=1, count=self.layout.count, bitorder="little")
        found = read_masks(self.layout, masks, places, self.blend)
        return np.clip(0.5 + self.sharpness * (found - 0.5), 0, 1) if self.blend else found


def read_masks(layout: Hemisphere, masks: np.ndarray, places: np.ndarray, blend: bool) -> np.ndarray:
    """Values (M, k) of masks (M, count) at places (k, 2) or (M, k, 2): of the nearest direction, or blended of four.

    Between rows the way counts in steps, along a row in parts of it; below the lowest row it is that one.
    """
    rows, azimuths = layout.elevations, layout.azimuths
    places = np.broadcast_to(places, (len(masks), *places.shape[-2:]))

    def cell(row: np.ndarray, turn: np.ndarray) -> np.ndarray:
        number = np.where(row >= rows, rows * azimuths, row * azimuths + turn % azimuths)
        return np.take_along_axis(masks, number, axis=1).astype(np.float64)

    height, turn = places[..., 0], places[..., 1]
    if not blend:
        return cell(np.floor(height).astype(int), np.floor(turn + 0.5).astype(int))
    above = np.maximum(height - 0.5, 0)
    row, first = np.floor(above).astype(int), np.floor(turn).astype(int)
    v, u = above - row, turn - first
    low = cell(row, first) * (1 - u) + cell(row, first + 1) * u
    high = cell(row + 1, first) * (1 - u) + cell(row + 1, first + 1) * u
    return np.asarray(low * (1 - v) + high * v)
