"""Two level planes cut to a disc: what the cut costs, bounce by bounce (Belcour 2009, section 5.2.2 and annex A.1).

Everything depends on the distance r from the axis alone, and the azimuth's integral of the kernel is closed:
K(r, s) = 2 s p / (p^2 - q^2)^(3/2), p = 1 + r^2 + s^2, q = 2 r s, in heights of the cloud base.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

NODES = 16
"""Gauss-Legendre nodes to each height of radius: the kernel's poles lie one height off, so the error is below 1e-14."""


@dataclass(frozen=True)
class TwoPlanes:
    """Radiosities summed over bounces.

    Attributes:
        radii: from the axis, in heights. ground, cloud: (bounces, radii), after 1, 2, ... bounces.
        endless_ground, endless_cloud: (bounces,) the same for planes without an edge.
    """

    radii: np.ndarray
    ground: np.ndarray
    cloud: np.ndarray
    endless_ground: np.ndarray
    endless_cloud: np.ndarray

    @property
    def ground_error(self) -> np.ndarray:
        """Relative error of the ground's radiosity for the cut, (bounces, radii)."""
        return self.ground / self.endless_ground[:, None] - 1

    @property
    def cloud_error(self) -> np.ndarray:
        """The same of the cloud's."""
        return self.cloud / self.endless_cloud[:, None] - 1


def exchange(r: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Kernel K(r, s), (len(r), len(s)): irradiance at r is the integral of K B over s."""
    r, s = np.asarray(r, np.float64)[:, None], np.asarray(s, np.float64)[None, :]
    return 2 * s * (1 + r * r + s * s) / ((1 + (r - s) ** 2) * (1 + (r + s) ** 2)) ** 1.5


def nodes(radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights over [0, radius], in panels of at most one height."""
    panels = max(int(np.ceil(radius)), 1)
    x, w = np.polynomial.legendre.leggauss(NODES)
    width = radius / panels
    places = (np.arange(panels)[:, None] + (x + 1) / 2) * width
    return places.ravel(), np.tile(w * width / 2, panels)


def solve(ground_albedo: float, reflectance: float, radius: float, bounces: int, radii: np.ndarray) -> TwoPlanes:
    """Sum bounces between the discs; the cloud starts with radiosity 1, the ground with 0.

    One bounce is from the cloud to the ground and back: n of them leave (reflectance albedo)^(n + 1) of the sum out.

    Args:
        ground_albedo, reflectance: of the ground and the cloud base, diffuse.
        radius: of both discs, in heights.
        radii: where the sums are wanted, in heights.
    """
    places, weights = nodes(radius)
    inner = exchange(places, places) * weights
    outer = exchange(radii, places) * weights
    leaving = np.ones(len(places))
    ground, cloud = np.zeros(len(radii)), np.ones(len(radii))
    found = []
    for _ in range(bounces):
        from_ground = ground_albedo * (inner @ leaving)
        ground = ground + ground_albedo * (outer @ leaving)
        leaving = reflectance * (inner @ from_ground)
        cloud = cloud + reflectance * (outer @ from_ground)
        found.append((ground, cloud))
    ratio = reflectance * ground_albedo
    powers = np.cumsum(ratio ** np.arange(bounces + 1))
    sums = np.array([pair[0] for pair in found]), np.array([pair[1] for pair in found])
    return TwoPlanes(np.asarray(radii, np.float64), *sums, ground_albedo * powers[:-1], powers[1:])
