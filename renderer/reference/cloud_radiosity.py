"""Truth of the light between ground and a level cloud base: form factors by rays or quadrature, bounced to the end.

Lengths are in heights of the cloud base over the elevation 0. A scene is a square that carries all light there is. Two
ways that share nothing with each other nor with the techniques:
- `by_rays`: rays of each point of ground and base, marched through the bilinear relief cell by cell, where they meet
  surfaces giving the light of what is met;
- `by_quadrature`: level ground only, the kernel 1 / (pi (1 + d^2)^2) integrated over each cell by Gauss-Legendre.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.signal import fftconvolve

from renderer.core.errors import InputError
from renderer.reference.cloud_radiosity_rays import cast, gather

CONVERGED = 1e-7
"""Iteration ends when the last term is below this share of the sum."""

MOST_CELLS = 181
"""Along a side, for rays: 2 N^2 numbers fit 16 bits."""

MOST = 4000
"""Half-bounces at most."""

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Scene:
    """A square of ground under a level base.

    Attributes:
        half: half of the square's side, in heights of the base.
        elevation: of the nodes between cells, in the same unit, (N + 1, N + 1); below 1. Axes [y, x].
        albedo, reflectance: of ground and base by cell, (N, N).
        ground, cloud: radiosity of either before any bounce, (N, N).
    """

    half: float
    elevation: np.ndarray
    albedo: np.ndarray
    reflectance: np.ndarray
    ground: np.ndarray
    cloud: np.ndarray

    @property
    def n(self) -> int:
        """Cells along a side."""
        return len(self.albedo)

    @property
    def level(self) -> bool:
        """Whether the ground lies at 0."""
        return bool(np.all(self.elevation == 0))


@dataclass(frozen=True)
class Solution:
    """Radiosity of ground and base with all bounces, by cell, and the standard error of each, (N, N)."""

    ground: np.ndarray
    cloud: np.ndarray
    ground_error: np.ndarray
    cloud_error: np.ndarray


def by_rays(
    scene: Scene, rays: int = 1024, batches: int = 4, seed: int = 1, progress: Progress | None = None
) -> Solution:
    """Solve by ray casting.

    Args:
        rays: of each point, in all; spread over the hemisphere by the cosine, each batch turned by chance.
        batches: solved apart, whose spread gives the standard error.
        seed: of the turns.

    Raises:
        InputError: ground above the base, or more cells than a hit can name.
    """
    if float(scene.elevation.max()) >= 1:
        raise InputError("elevation", "reaches the cloud base", "less than its height")
    if scene.n > MOST_CELLS:
        raise InputError("elevation", f"has {scene.n} cells along a side", f"at most {MOST_CELLS}")
    generator = np.random.default_rng(seed)
    found = []
    for batch in range(batches):
        if progress is not None:
            progress(batch / batches, f"rays, batch {batch + 1} of {batches}")
        turns = generator.random((2, scene.n, scene.n, 2))
        hits = cast(np.ascontiguousarray(scene.elevation, np.float64), scene.half, rays // batches, turns)

        def exchange(from_ground: np.ndarray, from_cloud: np.ndarray, hits: np.ndarray = hits) -> np.ndarray:
            return gather(hits, np.concatenate([from_ground.ravel(), from_cloud.ravel(), [0.0]]))

        found.append(_converge(scene, exchange))
    both = np.array(found)
    spread = both.std(axis=0, ddof=1) / np.sqrt(batches)
    return Solution(*both.mean(axis=0), *spread)


def by_quadrature(scene: Scene, order: int = 6) -> Solution:
    """Solve level ground by the exact kernel, at the cells' middles; each cell is one colour.

    Args:
        order: Gauss-Legendre nodes along either side of a cell; the error is how far half the order lies from it.

    Raises:
        InputError: ground that is not level.
    """
    if not scene.level:
        raise InputError("elevation", "is not level", "0 everywhere")
    fine, coarse = (_converge(scene, _convolution(scene, nodes)) for nodes in (order, order // 2))
    error = np.abs(np.array(fine) - np.array(coarse))
    return Solution(*fine, *error)


def _convolution(scene: Scene, order: int) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    n, cell = scene.n, 2 * scene.half / scene.n
    nodes, weights = np.polynomial.legendre.leggauss(order)
    places = (np.arange(-(n - 1), n)[:, None] + nodes / 2) * cell
    square = (places**2).ravel()
    kernel = 1 / (np.pi * (1 + square[:, None] + square[None, :]) ** 2)
    share = np.outer(weights, weights) * cell * cell / 4
    factors = np.einsum("iajb,ab->ij", kernel.reshape(2 * n - 1, order, 2 * n - 1, order), share)

    def exchange(from_ground: np.ndarray, from_cloud: np.ndarray) -> np.ndarray:
        return np.array([fftconvolve(field, factors, "same") for field in (from_cloud, from_ground)])

    return exchange


def _converge(scene: Scene, exchange: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Sum terms until they vanish; `exchange` gives the irradiance of ground and base, (2, N, N)."""
    ground, cloud = scene.ground.astype(np.float64), scene.cloud.astype(np.float64)
    term = ground, cloud
    for _ in range(MOST):
        arriving = exchange(*term)
        term = scene.albedo * arriving[0], scene.reflectance * arriving[1]
        ground, cloud = ground + term[0], cloud + term[1]
        if max(np.max(term[0]), np.max(term[1])) <= CONVERGED * max(np.max(ground), np.max(cloud)):
            return ground, cloud
    raise InputError("albedo", "bounces do not end", "a product of both albedos below 0.99")
