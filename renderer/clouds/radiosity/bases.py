"""Functions by which the light on ground and cloud base is described (Belcour 2009, section 5.2.2).

All live on one square of `GRID` x `GRID` cells of half a cloud height: the compute square of side 32H. Each is made of
parts, which are whole cells put together, and of a transform from the parts' means to coefficients, or none.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pywt
from scipy import sparse

GRID = 64
"""Cells along a side of the compute square."""

HALF = 16.0
"""Half of the compute square's side, in heights of the cloud base; the render square is half as wide (errata 001-7)."""

CELL = 2 * HALF / GRID

Kind = Literal["object", "solid_angle", "haar"]


@dataclass(frozen=True)
class Basis:
    """Functions on the compute square.

    Attributes:
        labels: number of the part that each cell belongs to, (GRID, GRID), from 0 on without gaps.
        transform: orthonormal rows that turn the parts' means into coefficients, (n, parts); none where each part has
            a coefficient of its own, whose value is its mean.
        kept: of wavelets, their rows in `haar_matrix`.
    """

    labels: np.ndarray
    transform: np.ndarray | None = None
    kept: np.ndarray | None = None

    @property
    def parts(self) -> int:
        """How many parts there are."""
        return int(self.labels.max()) + 1

    @property
    def sizes(self) -> np.ndarray:
        """Cells of each part, (parts,)."""
        return np.bincount(self.labels.ravel())

    @property
    def n(self) -> int:
        """How many coefficients."""
        return self.parts if self.transform is None else len(self.transform)

    def means(self, field: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
        """Mean of a field over each part: (..., GRID, GRID) to (..., parts). Cells weigh the same, or `weights`."""
        flat = np.reshape(field, (-1, GRID * GRID))
        weigh = np.ones(GRID * GRID) if weights is None else np.ravel(weights)
        gather = sparse.csr_array((weigh, (self.labels.ravel(), np.arange(GRID * GRID))))
        found = (gather @ flat.T).T / (gather @ np.ones(GRID * GRID))
        return found.reshape(*np.shape(field)[:-2], self.parts)

    def analyse(self, field: np.ndarray, weights: np.ndarray | None = None) -> np.ndarray:
        """Coefficients of a field, (..., n)."""
        means = self.means(field, weights)
        return means if self.transform is None else means @ self.transform.T

    def synthesise(self, coefficients: np.ndarray) -> np.ndarray:
        """The field of coefficients, (..., GRID, GRID)."""
        means = coefficients if self.transform is None else coefficients @ self.transform
        return means[..., self.labels]

    def multiply(self, means: np.ndarray) -> np.ndarray:
        """The product by a field of these means over the parts, as a matrix of coefficients, (..., n, n).

        Without a transform it is diagonal. With one it is the contraction of the triple products with the field's
        coefficients (formulas a9), done among the parts, where the product is pointwise.
        """
        if self.transform is None:
            return means[..., None] * np.eye(self.n, dtype=means.dtype)
        return (self.transform * means[..., None, :]) @ self.transform.T


def blocks(rows: int, columns: int) -> np.ndarray:
    """Labels of `rows` x `columns` blocks as equal as cells allow, row by row."""
    places = np.arange(GRID)
    return (places * rows // GRID)[:, None] * columns + (places * columns // GRID)[None, :]


def object_basis(coefficients: int) -> Basis:
    """Indicator functions of blocks as square as their number allows: 3 x 5, 8 x 8, 16 x 16."""
    rows = int(np.sqrt(coefficients))
    return Basis(blocks(rows, coefficients // rows))


@functools.lru_cache(maxsize=16)
def solid_angle_basis(coefficients: int, centre_height: float = 8.0) -> Basis:
    """Cells of equal solid angle seen from a point above the middle: fine there, coarse at the rim.

    Rings around the axis, cut into sectors; what the square's corners have beyond the last ring belongs to its sectors.

    Args:
        coefficients: how many cells.
        centre_height: of that point, in heights of the cloud base; the lower, the finer the middle.
    """
    rings = max(round(np.sqrt(coefficients / np.pi)), 1)
    # Cells about as wide as long: the k-th ring from the middle has a share of them that grows with its radius.
    shares = 2 * np.arange(rings) + 1
    sectors = np.maximum(np.round(shares * coefficients / shares.sum()), 1).astype(int)
    sectors[-1] += coefficients - sectors.sum()
    places = (np.arange(GRID) + 0.5) * CELL - HALF
    x, y = places[None, :], places[:, None]
    radius = np.hypot(x, y)
    lowest = centre_height / np.hypot(centre_height, HALF)
    share = (1 - centre_height / np.hypot(centre_height, radius)) / (1 - lowest)
    bounds = np.cumsum(sectors) / coefficients
    ring = np.minimum(np.searchsorted(bounds, share, side="right"), rings - 1)
    turn = (np.arctan2(y, x) / (2 * np.pi)) % 1
    sector = np.minimum((turn * sectors[ring]).astype(int), sectors[ring] - 1)
    labels = np.concatenate([[0], np.cumsum(sectors)[:-1]])[ring] + sector
    # A cell of the middle may be smaller than the grid's: no part is left empty.
    return Basis(np.unique(labels, return_inverse=True)[1].reshape(GRID, GRID))


HAAR_CELLS = 32
"""Cells along a side of the finest wavelets: of one cloud height."""


@functools.lru_cache(maxsize=4)
def haar_matrix(count: int = HAAR_CELLS) -> np.ndarray:
    """Haar's orthonormal wavelets on `count` x `count` cells, one a row, coarse first, (count^2, count^2)."""
    levels = int(np.log2(count))
    units = np.eye(count * count).reshape(-1, count, count)
    coefficients = pywt.wavedec2(units, "haar", mode="periodization", level=levels, axes=(-2, -1))
    parts = [coefficients[0].reshape(count * count, -1)]
    for details in coefficients[1:]:
        # Those of one place beside each other, horizontal, vertical, diagonal.
        parts.append(np.stack([d.reshape(count * count, -1) for d in details], axis=-1).reshape(count * count, -1))
    return np.ascontiguousarray(np.concatenate(parts, axis=1).T)


def haar_basis(kept: np.ndarray) -> Basis:
    """Some of Haar's wavelets, by their rows in `haar_matrix`."""
    rows = np.sort(kept)
    return Basis(blocks(HAAR_CELLS, HAAR_CELLS), haar_matrix()[rows], rows)


def largest_wavelets(fields: np.ndarray, coefficients: int, importance: np.ndarray | None = None) -> np.ndarray:
    """The wavelets that some fields need most: those of the largest coefficients.

    The coarsest are always kept, a quarter of all: the light of another hour may need them.

    Args:
        fields: (K, GRID, GRID), each of which counts alike.
        coefficients: how many.
        importance: of each cell, (GRID, GRID); a wavelet counts by what it has where it lies.
    """
    matrix, cells = haar_matrix(), Basis(blocks(HAAR_CELLS, HAAR_CELLS))
    means = cells.means(fields)
    norm = np.sqrt(np.sum(means**2, axis=-1, keepdims=True))
    energy = np.sum((means / np.where(norm > 0, norm, 1) @ matrix.T) ** 2, axis=0)
    if importance is not None:
        energy = energy * (matrix**2 @ cells.means(importance))
    coarse = 4 ** int(np.log2(max(coefficients / 4, 1)) / 2)
    energy[:coarse] = np.inf
    # The coarse one first among those that nothing needs.
    energy[energy < 1e-12] = 0
    return np.argsort(-energy, kind="stable")[:coefficients]


def triple_products(count: int) -> dict[tuple[int, int, int], float]:
    """Integrals of three wavelets of a `count` x `count` square that are not 0 (formulas a9), by their sorted rows.

    A product of two is one's value times the other where their squares are nested and 0 where they lie apart, so most
    vanish: of n^3 about n log n remain.
    """
    matrix = haar_matrix(count)
    found: dict[tuple[int, int, int], float] = {}
    for i in range(len(matrix)):
        for j in range(i, len(matrix)):
            product = matrix[i] * matrix[j]
            if not product.any():
                continue
            integrals = matrix[j:] @ product
            for k in np.flatnonzero(np.abs(integrals) > 1e-12):
                found[i, j, int(j + k)] = float(integrals[k])
    return found
