"""Haar wavelets, those of them that the light needs most."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.radiosity.bases import HAAR_CELLS, Basis, haar_basis, largest_wavelets
from renderer.clouds.radiosity.technique import BasisTechnique, InBasis, Solved

LEVELS = int(np.log2(HAAR_CELLS))
WIDTH = 3 * 2 ** (LEVELS - 1)
MEAN_ROW = 2**LEVELS - 1
"""Row of the texture that holds the mean; above it lie the levels, each as many rows as it has squares."""


class HaarBasis(BasisTechnique):
    """Wavelets: fine where light has edges, coarse elsewhere; products by the reflectance are triple products."""

    title: ClassVar[str] = "Haar wavelets"
    caption: ClassVar[str] = "The wavelets that the light needs most: fine at mountains and edges, coarse elsewhere."
    paper: ClassVar[str] = "Belcour 2009, section 5.2.2; Ng, Ramamoorthi & Hanrahan 2004 (triple products)"

    kind: Literal["haar"] = "haar"

    def chosen(self, coefficients: int, estimate: np.ndarray) -> Basis:
        """The largest of the estimate."""
        return haar_basis(largest_wavelets(estimate, coefficients))

    def pictures(self, solved: Solved) -> dict[str, np.ndarray]:
        """`ground_map` and `cloud_map`: heights of all wavelets, level by level, (32, 48, C)."""
        return {"ground_map": pyramid(solved.ground), "cloud_map": pyramid(solved.cloud)}


def pyramid(side: InBasis | None) -> np.ndarray:
    """A texel a wavelet, its height where it is positive first: level l in the rows from 2^l - 1 on, three beside each
    other for a square, which vary along y, along x and along both. The mean stands in the last row."""
    if side is None or side.basis.kept is None:
        return np.zeros((MEAN_ROW + 1, WIDTH, 3), np.float32)
    bands = len(side.coefficients)
    every = np.zeros((bands, HAAR_CELLS * HAAR_CELLS), np.float32)
    every[:, side.basis.kept] = side.coefficients
    found = np.zeros((MEAN_ROW + 1, WIDTH, bands), np.float32)
    found[MEAN_ROW, 0] = every[:, 0] / HAAR_CELLS
    for level in range(LEVELS):
        count = 2**level
        block = every[:, count * count : 4 * count * count].reshape(bands, count, 3 * count)
        found[count - 1 : 2 * count - 1, : 3 * count] = np.moveaxis(block, 0, -1) * (count / HAAR_CELLS)
    return found
