"""How much of the sky each voxel of the pattern sees through the canopy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.forest.edge_classes import blend_edges
from renderer.forest.pattern_kernels import add_transmittance

RINGS, AZIMUTHS = 4, 8
"""Directions over the hemisphere: rings of equal solid angle, each of equally spaced azimuths."""


def directions() -> np.ndarray:
    """Unit vectors (RINGS * AZIMUTHS, 3) that share the hemisphere's solid angle equally."""
    sine = (np.repeat(np.arange(RINGS), AZIMUTHS) + 0.5) / RINGS
    # Every other ring is turned by half a step, so that no azimuth is looked along twice.
    azimuth = (np.tile(np.arange(AZIMUTHS), RINGS) + 0.5 * (np.repeat(np.arange(RINGS), AZIMUTHS) % 2)) * (
        2 * np.pi / AZIMUTHS
    )
    flat = np.sqrt(1 - sine**2)
    return np.stack([np.sin(azimuth) * flat, np.cos(azimuth) * flat, sine], axis=1)


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
    rays = directions()
    for number, ray in enumerate(rays):
        shift = (ray[:2] / ray[2] * layer) @ np.linalg.inv(axes)
        parts = max(1, int(np.ceil(np.abs(shift).max() / 2)))
        add_transmittance(extinction, shift, layer / ray[2], parts, 1 / len(rays), prefix, result)
        progress((number + 1) / len(rays))
    return blend_edges(result, inner=3.0, outer=8.0)
