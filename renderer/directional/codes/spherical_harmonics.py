"""Spherical harmonics fitted to the mask on its hemisphere (Ramamoorthi & Hanrahan 2001; Sloan, Kautz & Snyder 2002).

On half a sphere they are not orthogonal, so coefficients are those of least squares over the directions. Any factor
of a function is its quantiser's, so `basis` leaves all out. Coefficient k has its bits from k * bits on, even steps
between the least and the most that the cloud has of it. Orders 1, 2, 3 and 4 are 5, 9, 17 and 33 bytes.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from renderer.directional.codes.code import get, put, word_count
from renderer.directional.hemisphere import Hemisphere

ORDERS = {5: (1, 10), 9: (2, 8), 17: (3, 8), 33: (4, 10)}
"""By bytes: the highest order, and bits of a coefficient."""


def basis(directions: np.ndarray, order: int) -> np.ndarray:
    """Functions (..., (order + 1)^2) at unit directions (..., 3), order by order."""
    x, y, z = np.moveaxis(np.asarray(directions, np.float64), -1, 0)
    xx, yy, zz = x * x, y * y, z * z
    found = [
        np.ones_like(x),
        y, z, x,
        x * y, y * z, 3 * zz - 1, x * z, xx - yy,
        y * (3 * xx - yy), x * y * z, y * (5 * zz - 1), z * (5 * zz - 3), x * (5 * zz - 1), z * (xx - yy),
        x * (xx - 3 * yy),
        x * y * (xx - yy), y * z * (3 * xx - yy), x * y * (7 * zz - 1), y * z * (7 * zz - 3),
        35 * zz * zz - 30 * zz + 3, x * z * (7 * zz - 3), (xx - yy) * (7 * zz - 1), x * z * (xx - 3 * yy),
        xx * (xx - 3 * yy) - yy * (3 * xx - yy),
    ]  # fmt: skip
    return np.stack(found[: (order + 1) ** 2], axis=-1)


@dataclass(frozen=True)
class SphericalHarmonics:
    """The first orders; see `fitted`.

    Args:
        layout: of the masks. size: bytes. ranges: (n, 2) least value of each coefficient, and a step of its code.
    """

    layout: Hemisphere
    size: int
    ranges: np.ndarray

    @property
    def order(self) -> int:
        """The highest."""
        return ORDERS[self.size][0]

    @property
    def bits(self) -> int:
        """Of a coefficient."""
        return ORDERS[self.size][1]

    def encode(self, masks: np.ndarray) -> np.ndarray:
        """As `Code`."""
        words = np.zeros((len(masks), word_count(self.size)), np.uint32)
        found = masks @ fit(self.layout, self.order).T
        codes = np.rint((found - self.ranges[:, 0]) / self.ranges[:, 1])
        codes = np.clip(codes, 0, (1 << self.bits) - 1).astype(np.uint32)
        for k in range(codes.shape[1]):
            put(words, k * self.bits, self.bits, codes[:, k])
        return words

    def evaluate(self, words: np.ndarray, places: np.ndarray) -> np.ndarray:
        """As `Code`."""
        elevation = np.minimum(places[..., 0] * self.layout.step, np.pi / 2)
        azimuth = places[..., 1] * (2 * np.pi / self.layout.azimuths)
        level = np.cos(elevation)
        towards = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], axis=-1)
        codes = np.stack([get(words, k * self.bits, self.bits) for k in range(len(self.ranges))], axis=1)
        values = self.ranges[:, 0] + codes * self.ranges[:, 1]
        functions = basis(towards, self.order)
        return np.asarray((functions @ values[..., None])[..., 0] if functions.ndim == 3 else values @ functions.T)

    def tables(self) -> dict[str, np.ndarray]:
        """`ranges`."""
        return {"ranges": self.ranges}


@cache
def fit(layout: Hemisphere, order: int) -> np.ndarray:
    """(n, count) what each coefficient takes of each direction."""
    return np.asarray(np.linalg.pinv(basis(layout.directions(), order)))


def fitted(layout: Hemisphere, size: int, masks: np.ndarray) -> SphericalHarmonics:
    """With the ranges of a cloud's masks (M, count): what any mask could have is many times as much."""
    order, bits = ORDERS[size]
    found = masks @ fit(layout, order).T
    least, most = found.min(axis=0), found.max(axis=0)
    step = np.maximum((most - least) / ((1 << bits) - 1), 1e-6)
    return SphericalHarmonics(layout, size, np.stack([least, step], axis=1))
