"""How much of the sky each voxel of the pattern sees through the canopy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.forest.edge_classes import blend_edges
from renderer.forest.pattern_kernels import add_transmittance

RINGS, AZIMUTHS = 4, 8
"""Directions over the hemisphere: rings of elevation, each of equally spaced azimuths."""


def directions() -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (RINGS * AZIMUTHS, 3) and their shares of the hemisphere's solid angle, summing to 1.

    The sines of the rings' elevations are the nodes of Gauss and Legendre, for whom the dark horizon is no trouble.
    """
    nodes, weights = np.polynomial.legendre.leggauss(RINGS)
    sine = np.repeat((nodes + 1) / 2, AZIMUTHS)
    # Every other ring is turned by half a step, so that no azimuth is looked along twice.
    turn = 0.5 * (np.repeat(np.arange(RINGS), AZIMUTHS) % 2)
    azimuth = (np.tile(np.arange(AZIMUTHS), RINGS) + turn) * (2 * np.pi / AZIMUTHS)
    flat = np.sqrt(1 - sine**2)
    rays = np.stack([np.sin(azimuth) * flat, np.cos(azimuth) * flat, sine], axis=1)
    return rays, np.repeat(weights / 2 / AZIMUTHS, AZIMUTHS)


def sky_share(extinction: np.ndarray, axes: np.ndarray, layer: float, progress: Callable[[float], None]) -> np.ndarray:
    """Mean transmittance from the upper hemisphere (uniform, no cosine) to each voxel's centre.

    Args:
        extinction: (K, J, I) [1/m], layer 0 lowest, periodic in J and I. axes: (2, 2) sides of a voxel [m] along i
        and j.
        layer: thickness [m]. progress: told the share done.

    Returns:
        float32 (K, J, I) in [0, 1], the same around all edges of one class.

    Source: formulas h (transmittance by prefix sums in a sheared grid).
    """
    extinction = np.ascontiguousarray(extinction, np.float32)
    result, prefix = np.zeros_like(extinction), np.empty_like(extinction)
    rays, shares = directions()
    for number, (ray, weight) in enumerate(zip(rays, shares, strict=True)):
        shift = (ray[:2] / ray[2] * layer) @ np.linalg.inv(axes)
        parts = max(1, int(np.ceil(np.abs(shift).max() / 2)))
        add_transmittance(extinction, shift, layer / ray[2], parts, weight, prefix, result)
        progress((number + 1) / len(rays))
    return blend_edges(result, inner=3.0, outer=8.0)
