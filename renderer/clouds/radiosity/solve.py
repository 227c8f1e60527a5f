"""Bounces by transfer matrices: a fixed number, a direct solution, or GMRES; one square or many at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from renderer.clouds.radiosity.bases import Basis
from renderer.clouds.radiosity.flat import series_tail
from renderer.clouds.radiosity.transfer import Transfer
from renderer.core.errors import InputError

Method = Literal["direct", "bounces", "gmres"]


@dataclass(frozen=True)
class Answers:
    """How ground and cloud answer light, as matrices of coefficients: albedo and reflectance, (..., n, n)."""

    ground: np.ndarray
    cloud: np.ndarray

    @classmethod
    def of(cls, ground: Basis, cloud: Basis, albedo: np.ndarray, reflectance: np.ndarray) -> Answers:
        """From maps (..., GRID, GRID)."""
        return cls(
            ground.multiply(ground.means(albedo)).astype(np.float32),
            cloud.multiply(cloud.means(reflectance)).astype(np.float32),
        )


def direct(
    transfer: Transfer, answers: Answers, ground_first: np.ndarray, cloud_first: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """All bounces by one linear system on the ground: (I - (G R C + S) rho) E = G b_cloud + (G R C + S) b_ground.

    Coefficients of the cloud that neither shine nor reflect are left out (Belcour 2009, section 5.2.3).

    Args:
        transfer: of one square. answers: of each band, (..., n, n).
        ground_first, cloud_first: coefficients of the radiosities before any bounce, (..., n).

    Returns:
        coefficients of the irradiance that bounces add, of ground and cloud.
    """
    active = np.any(answers.cloud != 0, axis=tuple(range(answers.cloud.ndim - 1)))
    there = transfer.from_cloud @ answers.cloud[..., active] @ transfer.from_ground[active] + transfer.on_ground
    arriving = times(transfer.from_cloud, cloud_first) + times(there, ground_first)
    system = np.eye(there.shape[-1], dtype=np.float32) - there @ answers.ground
    ground = np.linalg.solve(system, arriving[..., None])[..., 0]
    return ground, times(transfer.from_ground, times(answers.ground, ground) + ground_first)


def by_bounces(
    transfer: Transfer,
    answers: Answers,
    ground_first: np.ndarray,
    cloud_first: np.ndarray,
    half_bounces: int,
    tail: bool = False,
) -> tuple[np.ndarray, np.ndarray]:
    """A fixed number of half-bounces in Jacobi order (Belcour 2009, section 5.2.3; errata 001-20).

    Args:
        tail: add what later ones would, as `renderer.clouds.radiosity.flat.bounce` does.
    """
    from_ground, from_cloud = ground_first, cloud_first
    ground, cloud = np.zeros_like(ground_first), np.zeros_like(cloud_first)
    terms: list[tuple[np.ndarray, np.ndarray]] = []
    for _ in range(half_bounces):
        term = (
            times(transfer.from_cloud, from_cloud) + times(transfer.on_ground, from_ground),
            times(transfer.from_ground, from_ground),
        )
        ground, cloud = ground + term[0], cloud + term[1]
        from_ground, from_cloud = times(answers.ground, term[0]), times(answers.cloud, term[1])
        terms = [*terms[-3:], term]
    if tail and len(terms) == 4:
        ground, cloud = (
            total + series_tail([pair[side] for pair in terms], (-1,)) for side, total in enumerate((ground, cloud))
        )
    return ground, cloud


def by_gmres(
    transfer: Transfer, answers: Answers, ground_first: np.ndarray, cloud_first: np.ndarray, tolerance: float = 1e-6
) -> tuple[np.ndarray, np.ndarray]:
    """The same system without forming it, one band: products with the matrices until the rest is below `tolerance`.

    Raises:
        InputError: it does not end.
    """

    def there(light: np.ndarray) -> np.ndarray:
        reflected = answers.cloud @ (transfer.from_ground @ light)
        return transfer.from_cloud @ reflected + transfer.on_ground @ light

    n = len(ground_first)
    arriving = transfer.from_cloud @ cloud_first + there(ground_first)
    operator = LinearOperator((n, n), matvec=lambda e: e - there(answers.ground @ e), dtype=np.float32)
    ground, failed = gmres(operator, arriving, rtol=tolerance, atol=0.0, restart=min(n, 60), maxiter=20)
    if failed:
        raise InputError("albedo", "bounces do not end", "a product of both albedos below 1")
    return ground, transfer.from_ground @ (answers.ground @ ground + ground_first)


def times(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Product of matrices (..., m, n) and vectors (..., n)."""
    return (matrix @ vector[..., None])[..., 0]


class Squares:
    """Many squares at once, each solved beforehand for any light: a moved sun costs two products a square.

    Args:
        transfers: of each square; level ones share one.
        albedo, reflectance: means over the parts, (squares, bands, n), of bases without a transform.
    """

    def __init__(self, transfers: list[Transfer], albedo: np.ndarray, reflectance: np.ndarray) -> None:
        self._albedo = np.asarray(albedo, np.float32)
        squares, bands, n = self._albedo.shape
        many = reflectance.shape[-1]
        self._respond = np.empty((squares, bands, n, n + many), np.float32)
        self._down = np.empty((squares, many, n), np.float32)
        for k, transfer in enumerate(transfers):
            self._down[k] = transfer.from_ground
            for band in range(bands):
                shine = np.asarray(reflectance[k, band], np.float32)
                active = shine != 0
                there = (transfer.from_cloud[:, active] * shine[active]) @ transfer.from_ground[active]
                there += transfer.on_ground
                system = np.eye(n, dtype=np.float32) - there * self._albedo[k, band]
                right = np.concatenate([there, transfer.from_cloud], axis=1)
                self._respond[k, band] = np.linalg.solve(system, right)

    def solve(self, ground_first: np.ndarray, cloud_first: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Irradiance that bounces add to ground and cloud, (squares, bands, n) each, of the radiosities before any."""
        light = np.concatenate([ground_first, cloud_first], axis=-1)
        ground = np.matmul(self._respond, light[..., None])[..., 0]
        leaving = self._albedo * ground + ground_first
        return ground, np.matmul(leaving, self._down.transpose(0, 2, 1))
