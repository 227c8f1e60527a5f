"""Truth for a plane cloud: photons followed one by one through a slab, by Monte Carlo (after Marchuk et al. 1980).

Analog: every photon counts 1 until it leaves or is absorbed, so that all shares are binomial and their standard
errors known. It shares nothing with the techniques it judges; the phase function comes as an array.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from renderer.reference.cloud_photons import ORDERS, Scatterer, draw_cosine, in_blocks, turned, uniform


@dataclass(frozen=True)
class SlabPhotons:
    """Where photons left a slab.

    Attributes:
        photons: how many came.
        up, down: (ORDERS,) how many left on the sunlit side and on the other, by order: 0, 1, 2, 3 or more.
        up_bins, down_bins: (ORDERS, M, A) the same by the cosine of the direction and its azimuth, between 0
        (straight on)
            and pi, both sides of the sun's plane together; order 0 is in none.
        cosine_edges: (M + 1,). azimuth_edges: (A + 1,) rad.
    """

    photons: int
    up: np.ndarray
    down: np.ndarray
    up_bins: np.ndarray
    down_bins: np.ndarray
    cosine_edges: np.ndarray
    azimuth_edges: np.ndarray

    def share(self, up: bool, orders: slice = slice(None)) -> tuple[float, float]:
        """Share of the photons that left on a side in some orders, and its standard error."""
        found = int((self.up if up else self.down)[orders].sum()) / self.photons
        return found, math.sqrt(max(found * (1 - found), 1.0 / self.photons) / self.photons)

    def radiance(self, up: bool, orders: slice = slice(None)) -> tuple[np.ndarray, np.ndarray]:
        """Mean radiance (M, A) of each bin for each unit of irradiance on the level, 1/sr, and its standard error."""
        counts = (self.up_bins if up else self.down_bins)[orders].sum(axis=0)
        # Mean over the bin of radiance times cosine, over the mean cosine; two half planes share a bin.
        projected = np.diff(self.cosine_edges**2 / 2)[:, None] * np.diff(self.azimuth_edges) * 2
        share = counts / self.photons
        error = np.sqrt(np.maximum(share * (1 - share), 1.0 / self.photons) / self.photons)
        return share / projected, error / projected


def trace_slab(
    scatterer: Scatterer,
    depth: float,
    mu_sun: float,
    photons: int,
    seed: int,
    *,
    albedo: float = 1.0,
    bins: tuple[int, int] = (20, 12),
    threads: int = 2,
) -> SlabPhotons:
    """Follow photons through a slab.

    Args:
        scatterer: the phase function.
        depth: optical depth along the normal. mu_sun: cosine of the sun's zenith angle, positive.
        photons: how many. seed: of all draws.
        albedo: share of a meeting that is scattered.
        bins: of the cosine, even from 0 to 1, and of the azimuth, even from 0 to pi.
        threads: on which blocks of photons run; they change nothing.
    """
    def block(state: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
        sides = np.zeros((2, ORDERS), np.int64)
        found = np.zeros((2, ORDERS, *bins), np.int64)
        _trace(state, count, depth, mu_sun, albedo, tables, sides, found)
        return sides, found

    tables = scatterer.tables()
    results = in_blocks(block, photons, seed, threads)
    sides = sum(result[0] for result in results)
    found = sum(result[1] for result in results)
    edges = np.linspace(0, 1, bins[0] + 1), np.linspace(0, np.pi, bins[1] + 1)
    return SlabPhotons(photons, sides[0], sides[1], found[0], found[1], *edges)


@njit(cache=True, nogil=True)
def _trace(state, photons, depth, mu_sun, albedo, tables, sides, bins) -> None:
    """One block of photons: `sides` (2, ORDERS) and `bins` (2, ORDERS, M, A) are counted up."""
    cosines, azimuths = bins.shape[2], bins.shape[3]
    sine = math.sqrt(1.0 - mu_sun * mu_sun)
    for _ in range(photons):
        # z is the optical depth below the top; directions point down where z grows.
        x, y, z, place, order = sine, 0.0, mu_sun, 0.0, 0
        while True:
            place += -math.log(1.0 - uniform(state)) * z
            if place < 0.0 or place > depth:
                break
            if albedo < 1.0 and uniform(state) >= albedo:
                order = -1
                break
            order += 1
            x, y, z = turned(x, y, z, draw_cosine(uniform(state), *tables), state)
        if order < 0:
            continue
        side = 0 if place < 0.0 else 1
        kept = min(order, ORDERS - 1)
        sides[side, kept] += 1
        if order:
            azimuth = abs(math.atan2(y, x))
            row = min(int(abs(z) * cosines), cosines - 1)
            bins[side, kept, row, min(int(azimuth / math.pi * azimuths), azimuths - 1)] += 1
