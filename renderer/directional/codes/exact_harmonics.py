"""All harmonics of the mask, in full precision: what the principal ones leave out (Porquet 2005, section 3.3.2.3).

The discrete Fourier transform loses nothing, so its coefficients need not be stored to be summed: the sum of all waves
at a place is that of the mask's ones, each times the wave packet of its azimuth and row,
D(x) = sin(pi x) / (N tan(pi x / N)), which is 1 at its own and 0 at all others. So the words are the mask's bits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.directional.codes.bits import Bits
from renderer.directional.codes.code import zenith_share
from renderer.directional.hemisphere import Hemisphere


def packet(x: np.ndarray, count: int) -> np.ndarray:
    """Sum of all waves of a period of so many steps, an even number, that are 1 at 0 and at no other step."""
    turned = x / count - np.floor(x / count + 0.5)
    near = np.abs(turned) < 1e-7
    safe = np.where(near, 0.25, turned)
    # Half a turn away the tangent has its pole, and the packet is 0.
    wave = np.sin(np.pi * count * safe) * np.cos(np.pi * safe) / np.sin(np.pi * safe) / count
    return np.asarray(np.where(near, 1.0, wave))


@dataclass(frozen=True)
class ExactHarmonics:
    """Every harmonic of each point's mask.

    Args:
        layout: of the masks.
    """

    layout: Hemisphere

    @property
    def size(self) -> int:
        """Bytes."""
        return Bits(self.layout).size

    def encode(self, masks: np.ndarray) -> np.ndarray:
        """As `Code`."""
        return Bits(self.layout).encode(masks)

    def evaluate(self, words: np.ndarray, places: np.ndarray) -> np.ndarray:
        """As `Code`."""
        rows, azimuths = self.layout.elevations, self.layout.azimuths
        places = np.broadcast_to(places, (len(words), *places.shape[-2:]))
        octets = np.ascontiguousarray(words).view(np.uint8)
        masks = np.unpackbits(octets, axis=1, count=self.layout.count, bitorder="little").astype(np.float64)
        row = np.clip(places[..., 0] - 0.5, 0, rows - 1)
        up = packet(row[..., None] - np.arange(rows), rows)
        around = packet(places[..., 1, None] - np.arange(azimuths), azimuths)
        found = np.einsum("mij,mki,mkj->mk", masks[:, :-1].reshape(-1, rows, azimuths), up, around, optimize=True)
        return np.asarray(found + (masks[:, -1:] - found) * zenith_share(self.layout, places))
