"""Truth for a cloud round a spherical Earth: the same photons as in the plane slab, between two spheres.

Photons of one sun meet the top of the layer where the sun stands at a given height, are followed through it, out of
it below and, where the Earth does not catch them, through the clear air into it again (formulas a8). Lengths are
metres, in float64.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from renderer.reference.cloud_photons import ORDERS, Scatterer, draw_cosine, in_blocks, turned, uniform

SPACE, GROUND = 0, 1
"""Where a photon ends: above the layer, or on the Earth, which is black here."""


@dataclass(frozen=True)
class Shell:
    """A layer of even extinction round a sphere.

    Attributes:
        radius: of the Earth. base: of the layer above it. thickness: of the layer. All m.
        extinction: m-1.
    """

    radius: float
    base: float
    thickness: float
    extinction: float


@dataclass(frozen=True)
class ShellPhotons:
    """Where photons ended.

    Attributes:
        photons: how many came.
        ended: (2, ORDERS) how many reached SPACE and GROUND, by order: 0, 1, 2, 3 or more.
        gaps: how many crossed the clear air below the layer without meeting the Earth.
        leaving: (M,) of those that reached space scattered, by the cosine of their direction to the local normal.
        rising: (M,) of these, how many left within one degree of arc of where they came.
    """

    photons: int
    ended: np.ndarray
    gaps: int
    leaving: np.ndarray
    rising: np.ndarray

    def share(self, where: int, orders: slice = slice(None)) -> tuple[float, float]:
        """Share of the photons that ended there in some orders, and its standard error."""
        found = int(self.ended[where, orders].sum()) / self.photons
        return found, math.sqrt(max(found * (1 - found), 1.0 / self.photons) / self.photons)


def trace_shell(
    scatterer: Scatterer, shell: Shell, mu_sun: float, photons: int, seed: int, *, bins: int = 20, threads: int = 2
) -> ShellPhotons:
    """Follow photons through a shell.

    Args:
        scatterer: the phase function.
        shell: the layer.
        mu_sun: cosine of the sun's zenith angle at the top of the layer, where they come in.
        photons: how many. seed: of all draws.
        bins: of the cosine, even from 0 to 1.
        threads: on which blocks of photons run; they change nothing.
    """
    inner = shell.radius + shell.base
    radii = (shell.radius, inner, inner + shell.thickness)

    def block(state: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        ended = np.zeros((2, ORDERS), np.int64)
        leaving = np.zeros((2, bins), np.int64)
        gaps = np.zeros(1, np.int64)
        _trace(state, count, radii, shell.extinction, mu_sun, tables, ended, leaving, gaps)
        return ended, leaving, gaps

    tables = scatterer.tables()
    results = in_blocks(block, photons, seed, threads)
    ended, leaving, gaps = (sum(result[part] for result in results) for part in range(3))
    return ShellPhotons(photons, ended, int(gaps[0]), leaving[0], leaving[1])


@njit(cache=True, nogil=True)
def _near_far(px, py, pz, dx, dy, dz, radius) -> tuple[float, float]:
    """Distances at which a ray crosses a sphere round the origin, infinite where it does not."""
    b = px * dx + py * dy + pz * dz
    size = math.sqrt(px * px + py * py + pz * pz)
    c = (size - radius) * (size + radius)
    square = b * b - c
    if square <= 0.0:
        return math.inf, math.inf
    root = math.sqrt(square)
    # The form without cancellation for the root nearer to 0.
    if b > 0.0:
        return -b - root, -c / (b + root)
    far = -b + root
    return c / far, far


@njit(cache=True, nogil=True)
def _trace(state, photons, radii, extinction, mu_sun, tables, ended, leaving, gaps):
    """One block of photons: `ended` (2, ORDERS), `leaving` (2, M) and `gaps` (1,) are counted up."""
    earth, inner, outer = radii
    bins = leaving.shape[1]
    sine = math.sqrt(1.0 - mu_sun * mu_sun)
    degree = math.cos(math.pi / 180.0)
    for _ in range(photons):
        px, py, pz = 0.0, 0.0, outer
        dx, dy, dz, order = sine, 0.0, -mu_sun, 0
        where = -1
        while where < 0:
            free = -math.log(1.0 - uniform(state)) / extinction
            out = _near_far(px, py, pz, dx, dy, dz, outer)[1]
            down, again = _near_far(px, py, pz, dx, dy, dz, inner)
            if down <= 1e-7:
                down = math.inf
            if free < min(out, down):
                px, py, pz = px + free * dx, py + free * dy, pz + free * dz
                order += 1
                dx, dy, dz = turned(dx, dy, dz, draw_cosine(uniform(state), *tables), state)
            elif down < out:
                ground = _near_far(px, py, pz, dx, dy, dz, earth)[0]
                if ground < math.inf:
                    where = 1
                else:
                    gaps[0] += 1
                    px, py, pz = px + again * dx, py + again * dy, pz + again * dz
            else:
                where = 0
                px, py, pz = px + out * dx, py + out * dy, pz + out * dz
        ended[where, min(order, ORDERS - 1)] += 1
        if where == 0 and order:
            up = (px * dx + py * dy + pz * dz) / outer
            row = min(max(int(up * bins), 0), bins - 1)
            leaving[0, row] += 1
            if pz / outer > degree:
                leaving[1, row] += 1
