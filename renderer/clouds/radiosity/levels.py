"""Light between two level planes by three mip levels (Bouthors, Neyret and Lefebvre 2006, as Belcour 2009, 5.1.1)."""

from __future__ import annotations

import numpy as np
from scipy import fft

from renderer.clouds.radiosity.form_factors import LEVELS, Reading, level_weights


class ThreeLevelExchange:
    """Turns the radiosity of one plane into the irradiance of the other by the means of three footprints.

    Args:
        n: cells along a side. cell: side of one, a whole part of the levels' widths where these are wider.
        height: of the cloud base, same unit.
        reading: of the footprints (formulas a7): the `texels` of size H, 2H and 8H that hold the point, bilinear `taps`
            between their middles, or `discs` of radius H, 2H and 8H around it.

    Raises:
        ValueError: texels that the grid cannot be cut into.
    """

    def __init__(self, n: int, cell: float, height: float, reading: Reading) -> None:
        self.n = n
        self.reading = reading
        self.weights = level_weights(reading)
        widths = [max(width * height / cell, 1.0) for width in LEVELS]
        self._cells = [round(width) for width in widths]
        if reading != "discs":
            if np.abs(np.subtract(widths, self._cells)).max() > 1e-6 or n % self._cells[-1]:
                raise ValueError(f"{n} cells of {cell} cannot be cut into texels of {LEVELS} times {height}")
            return
        self._size = fft.next_fast_len(n + 2 * self._cells[-1], real=True)
        kernels = np.stack([_disc_mean(width * height / cell, self._size) for width in LEVELS])
        self._spectra = fft.rfft2(kernels).real.astype(np.float32)

    def __call__(self, radiosity: np.ndarray) -> np.ndarray:
        """Irradiance of the plane opposite, (..., N, N); nothing shines beyond the grid."""
        if self.reading == "discs":
            return self._convolved(radiosity, np.tensordot(self.weights.astype(np.float32), self._spectra, 1))
        return sum(weight * mean for weight, mean in zip(self.weights, self.means(radiosity), strict=True))

    def means(self, radiosity: np.ndarray) -> list[np.ndarray]:
        """Means over the three footprints of every cell, (..., N, N) each; nothing shines beyond the grid."""
        if self.reading == "discs":
            return [self._convolved(radiosity, spectrum) for spectrum in self._spectra]
        read = spread_texels if self.reading == "texels" else taps
        return [read(block_means(radiosity, width), width) for width in self._cells]

    def _convolved(self, radiosity: np.ndarray, spectrum: np.ndarray) -> np.ndarray:
        shape = (self._size, self._size)
        return fft.irfft2(fft.rfft2(radiosity, shape) * spectrum, shape)[..., : self.n, : self.n]

    def spread(self, radiosity: np.ndarray) -> np.ndarray:
        """The same where the plane goes on beyond the grid with its mean over it."""
        mean = radiosity.mean(axis=(-2, -1), keepdims=True)
        return self(radiosity - mean) + mean


def block_means(field: np.ndarray, width: int) -> np.ndarray:
    """Means over blocks of width x width cells: a mip level."""
    *first, rows, columns = field.shape
    return field.reshape(*first, rows // width, width, columns // width, width).mean(axis=(-3, -1))


def spread_texels(means: np.ndarray, width: int) -> np.ndarray:
    """Each cell gets its block's value."""
    return means.repeat(width, axis=-2).repeat(width, axis=-1)


def taps(means: np.ndarray, width: int) -> np.ndarray:
    """Each cell gets the bilinear value between the blocks' middles, 0 beyond the grid."""
    for axis in (-2, -1):
        means = _taps_along(np.moveaxis(means, axis, -1), width)
        means = np.moveaxis(means, -1, axis)
    return means


def _taps_along(means: np.ndarray, width: int) -> np.ndarray:
    count = means.shape[-1]
    padded = np.pad(means, [(0, 0)] * (means.ndim - 1) + [(1, 1)])
    at = (np.arange(count * width) + 0.5) / width + 0.5
    low = at.astype(int)
    share = (at - low).astype(means.dtype)
    return padded[..., low] * (1 - share) + padded[..., low + 1] * share


def _disc_mean(radius: float, size: int) -> np.ndarray:
    """A kernel that takes the mean over a disc, cells at its rim by the share inside; offset 0 at index 0."""
    fine = 8
    reach = int(np.ceil(radius + 0.5))
    places = (np.arange((2 * reach + 1) * fine) + 0.5) / fine - reach - 0.5
    inside = (places[:, None] ** 2 + places[None, :] ** 2 <= radius * radius).astype(np.float64)
    disc = block_means(inside, fine)
    kernel = np.zeros((size, size))
    index = np.arange(-reach, reach + 1) % size
    kernel[np.ix_(index, index)] = disc / disc.sum()
    return kernel
