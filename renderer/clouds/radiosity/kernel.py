"""Light between two level planes by one convolution a half-bounce: the exact kernel on a grid (formulas a7)."""

from __future__ import annotations

import functools

import numpy as np
from scipy import fft

from renderer.clouds.radiosity.form_factors import cells, rectangle


class FlatExchange:
    """Turns the radiosity of one plane into the irradiance of the other, both on one square grid.

    E(x) = integral of B(y) H^2 / (pi (H^2 + |x - y|^2)^2) dy, B constant in a cell, E its mean over a cell: no levels,
    no cut-off but the grid's own edge. O(N^2 log N) a half-bounce.

    Args:
        n: cells along a side.
        cell: side of a cell. height: of the cloud base, same unit.
        points: irradiance at the cells' middles instead of its mean over them.
    """

    def __init__(self, n: int, cell: float, height: float, points: bool = False) -> None:
        self.n = n
        self.size = fft.next_fast_len(2 * n - 1, real=True)
        self.factors = points_to_cells(n - 1, cell, height) if points else cells(n - 1, cell, height)
        # Wrapped so that the offset 0 stands first.
        wrapped = np.zeros((self.size, self.size))
        index = np.arange(-(n - 1), n) % self.size
        wrapped[np.ix_(index, index)] = self.factors
        spectrum = fft.rfft2(wrapped)
        self._spectrum = spectrum.real.astype(np.float64)  # even in both axes
        self._spectrum32 = self._spectrum.astype(np.float32)

    def __call__(self, radiosity: np.ndarray) -> np.ndarray:
        """Irradiance of the plane opposite; nothing shines beyond the grid.

        Args:
            radiosity: (..., N, N), float32 stays float32.
        """
        spectrum = self._spectrum32 if radiosity.dtype == np.float32 else self._spectrum
        # Axis by axis: rows of padding need no transform, neither those that come in nor those that are cut off.
        waves = fft.fft(fft.rfft(radiosity, self.size), self.size, axis=-2, overwrite_x=True)
        waves *= spectrum
        rows = fft.ifft(waves, axis=-2, overwrite_x=True)[..., : self.n, :]
        return np.asarray(fft.irfft(rows, self.size)[..., : self.n])

    def spread(self, radiosity: np.ndarray) -> np.ndarray:
        """The same where the plane goes on beyond the grid with its mean over it, so that a uniform plane stays so."""
        mean = radiosity.mean(axis=(-2, -1), keepdims=True)
        return self(radiosity - mean) + mean


def points_to_cells(reach: int, cell: float, height: float) -> np.ndarray:
    """Form factors of the cells of the plane opposite seen from a cell's middle, (2 reach + 1, 2 reach + 1)."""
    edges = (np.arange(-reach, reach + 2) - 0.5) * cell
    x, y = (edges[:-1, None], edges[1:, None]), (edges[None, :-1], edges[None, 1:])
    return rectangle(x, y, height)


@functools.lru_cache(maxsize=8)
def flat_exchange(n: int, cell_over_height: float, points: bool = False) -> FlatExchange:
    """The exchange of a grid, made once."""
    return FlatExchange(n, cell_over_height, 1.0, points)
