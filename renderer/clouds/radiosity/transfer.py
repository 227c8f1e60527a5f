"""Matrices of light between ground and cloud base over one compute square (Belcour 2009, section 5.2.1).

Rows are receivers: E_ground = G B_cloud + S B_ground, E_cloud = C B_ground, of radiosities B and irradiances E. Albedo
and reflectance stay outside: they may change without the matrices. The thesis has them transposed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import as_strided
from scipy import sparse

from renderer.clouds.radiosity.bases import CELL, GRID, Basis
from renderer.clouds.radiosity.kernel import flat_exchange
from renderer.clouds.radiosity.relief import Hits


@dataclass(frozen=True)
class Transfer:
    """Matrices between coefficients of the ground's and the cloud's basis, float32.

    Attributes:
        from_cloud: G, (n_ground, n_cloud). from_ground: C, (n_cloud, n_ground). on_ground: S, (n_ground, n_ground).
    """

    from_cloud: np.ndarray
    from_ground: np.ndarray
    on_ground: np.ndarray

    def arrays(self) -> dict[str, np.ndarray]:
        """As a bake keeps them."""
        return {"from_cloud": self.from_cloud, "from_ground": self.from_ground, "on_ground": self.on_ground}

    @classmethod
    def of(cls, arrays: Mapping[str, np.ndarray]) -> Transfer:
        """From what a bake kept."""
        return cls(*(np.asarray(arrays[name], np.float32) for name in ("from_cloud", "from_ground", "on_ground")))

    @property
    def flat(self) -> bool:
        """Whether no ground sees any ground."""
        return not self.on_ground.any()


@dataclass(frozen=True)
class Detail:
    """What is known to be finer than a basis' parts, (GRID, GRID) each: how light lies within a part.

    A part's mean irradiance is weighed by what answers it, and what leaves a part is spread as that answer: the light
    of a summit with snow comes from its snow. A matrix still takes mean radiosities to irradiances.

    Attributes:
        albedo: of the ground, its mean over the bands; it is inside G, C and S then in as far as it varies in a part.
        cover: reflectance of the cloud base, the same.
        edge: light also falls towards the square's edge as the whole square's form factor does there: for squares with
            nothing beyond.
    """

    albedo: np.ndarray | None = None
    cover: np.ndarray | None = None
    edge: bool = False

    def ground(self) -> tuple[np.ndarray, np.ndarray]:
        """Weight of irradiance and density of radiosity on the ground."""
        return self._of(self.albedo)

    def cloud(self) -> tuple[np.ndarray, np.ndarray]:
        """The same on the cloud base."""
        return self._of(self.cover)

    def _of(self, answer: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        weight = np.ones((GRID, GRID)) if answer is None else np.maximum(answer, 1e-6)
        return weight, weight * flat_exchange(GRID, CELL)(np.ones((GRID, GRID))) if self.edge else weight


PLAIN = Detail()
"""Nothing is known within a part."""


@dataclass(frozen=True)
class _Side:
    """One surface of a transfer: its basis, the weight of its cells' irradiance, the density of its radiosity."""

    basis: Basis
    weight: np.ndarray
    density: np.ndarray

    @classmethod
    def of(cls, basis: Basis, weight: np.ndarray, density: np.ndarray, area: np.ndarray) -> _Side:
        mean = basis.means(density, area)
        weighed = weight * area
        return cls(basis, weighed / (basis.means(weighed) * basis.sizes)[basis.labels], density / mean[basis.labels])

    def only(self, cells: np.ndarray) -> _Side:
        """What some cells have of each part's irradiance."""
        return replace(self, weight=self.weight * cells)

    def most(self) -> np.ndarray:
        """Mean radiosity of each part where its brightest cell has 1, (parts,)."""
        found = np.zeros(self.basis.parts)
        np.maximum.at(found, self.basis.labels.ravel(), self.density.ravel())
        return 1 / found


def flat_transfer(ground: Basis, cloud: Basis, detail: Detail = PLAIN, scale: float = 1.0) -> Transfer:
    """The matrices over level ground, from the exact form factors between cells; one set serves every level square.

    Args:
        scale: of the square against that of side 32H.
    """
    level = np.ones((GRID, GRID))
    below, above = _Side.of(ground, *detail.ground(), level), _Side.of(cloud, *detail.cloud(), level)
    from_cloud, from_ground = _flat_parts(below, above, scale), _flat_parts(above, below, scale)
    return Transfer(
        _transformed(from_cloud, ground, cloud),
        _transformed(from_ground, cloud, ground),
        np.zeros((ground.n, ground.n), np.float32),
    )


def closed(transfer: Transfer, ground: Basis, cloud: Basis) -> Transfer:
    """The same where all goes on beyond the square with its mean over it, so that uniform planes stay uniform."""
    from_cloud = transfer.from_cloud + _missing(ground, cloud, transfer.from_cloud, transfer.on_ground)
    from_ground = transfer.from_ground + _missing(cloud, ground, transfer.from_ground, None)
    return Transfer(from_cloud.astype(np.float32), from_ground.astype(np.float32), transfer.on_ground)


def _missing(to: Basis, of: Basis, matrix: np.ndarray, own: np.ndarray | None) -> np.ndarray:
    """What rows lack of 1, times the mean."""
    one = np.ones((GRID, GRID))
    lack = to.analyse(one) - matrix @ of.analyse(one)
    if own is not None:
        lack = lack - own @ to.analyse(one)
    mean = of.sizes / of.sizes.sum()
    return np.outer(lack, mean if of.transform is None else of.transform @ mean)


def _flat_parts(to: _Side, of: _Side, scale: float = 1.0) -> np.ndarray:
    """Mean form factors from parts of `to` to parts of `of`, (parts, parts)."""
    factors = flat_exchange(GRID, CELL * scale).factors
    down, across = factors.strides
    middle = factors[GRID - 1 :, GRID - 1 :]
    # From each row of cells to all cells: [column, other row, other column], offsets counted back from the middle.
    found = np.zeros((to.basis.parts, GRID * GRID))
    for row in range(GRID):
        seen = as_strided(middle[row:], (GRID, GRID, GRID), (across, -down, -across)).reshape(GRID, -1)
        parts, which = np.unique(to.basis.labels[row], return_inverse=True)
        found[parts] += sparse.csr_array((to.weight[row], (which, np.arange(GRID))), (len(parts), GRID)) @ seen
    cells = np.arange(GRID * GRID)
    sent = sparse.csr_array((of.density.ravel(), (of.basis.labels.ravel(), cells)), (of.basis.parts, GRID * GRID))
    return np.asarray((sent @ found.T).T)


def relief_transfer(hits: Hits, ground: Basis, cloud: Basis, detail: Detail = PLAIN) -> Transfer:
    """The matrices over relief, counted from what rays meet.

    Level cells have the exact form factors of level ground and what relief changes of them: the same rays are counted
    with and without it, so that their chance cancels wherever it changes nothing.
    """
    one, area = np.ones((GRID, GRID)), hits.area.reshape(GRID, GRID)
    below, above = _Side.of(ground, *detail.ground(), one), _Side.of(cloud, *detail.cloud(), one)
    slopes = _Side.of(ground, *detail.ground(), area)
    level = slopes.only(np.isclose(area, CELL * CELL, rtol=1e-9))
    sky = _counted(hits.ground, slopes, above, GRID * GRID)
    sky += _flat_parts(level, above) - _counted(hits.level_ground, level, above, GRID * GRID)
    land = _counted(hits.ground, slopes, slopes, 0)
    down = _counted(hits.cloud, above, slopes, 0)
    down += _flat_parts(above, below) - _counted(hits.level_cloud, above, below, 0)
    (sky, land), (down,) = _shares((sky, above), (land, slopes)), _shares((down, slopes))
    return Transfer(
        _transformed(sky, ground, cloud), _transformed(down, cloud, ground), _transformed(land, ground, ground)
    )


def _shares(*parts: tuple[np.ndarray, _Side]) -> list[np.ndarray]:
    """The same with no row above 1 for radiosities of at most 1, all together, whatever chance made of it.

    What chance put below 0 stays: to cut it there would add light.
    """
    total = sum(matrix @ side.most() for matrix, side in parts)
    return [matrix / np.maximum(total, 1.0)[:, None] for matrix, _ in parts]


def _counted(met: np.ndarray, to: _Side, of: _Side, first: int) -> np.ndarray:
    """Share of each part's rays that meet each part of a surface, (parts, parts).

    Args:
        met: numbers of the cells that each cell's rays meet, (cells, rays). first: number of that surface's first cell.
    """
    cells, rays = met.shape
    index = met.astype(np.int64) - first
    inside = (index >= 0) & (index < cells)
    index = index[inside]
    row = np.broadcast_to(to.basis.labels.reshape(-1, 1), met.shape)[inside]
    weight = np.broadcast_to(to.weight.reshape(-1, 1), met.shape)[inside] * of.density.ravel()[index]
    many, wide = to.basis.parts, of.basis.parts
    counts = np.bincount(row * wide + of.basis.labels.ravel()[index], weight, many * wide).reshape(many, wide)
    return counts / rays


def _transformed(parts: np.ndarray, to: Basis, of: Basis) -> np.ndarray:
    found = parts.astype(np.float32)
    if to.transform is not None:
        found = to.transform.astype(np.float32) @ found
    if of.transform is not None:
        found = found @ of.transform.T.astype(np.float32)
    return found
