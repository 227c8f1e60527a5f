"""Which part of the sky each place sees: by its trees, for every voxel of the pattern, and by the land, for every node.

Both are kept as the mean over the upper hemisphere and the mean direction of what is seen; four numbers say how much of
any sky arrives, and from where, as far as visibility is linear in the direction.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from renderer.core.technique import Arrays, Bake
from renderer.forest.ambient import directions
from renderer.forest.species_alone import each_section, opacities
from renderer.forest.transmittance import extinction_of, transmittance
from renderer.forest.world_scale import CELL
from renderer.world.horizon_sweep import sweeps

AZIMUTHS = 32
"""Directions in which the land's horizon is swept."""


def packed(seen: np.ndarray) -> np.ndarray:
    """Moments (..., 4) as bytes: the mean and the part along z from 0 to 1, those along x and y from -1 to 1."""
    scaled = np.concatenate([seen[..., :1], 0.5 + 0.5 * seen[..., 1:3], seen[..., 3:]], axis=-1)
    found: np.ndarray = np.rint(255 * np.clip(scaled, 0, 1)).astype(np.uint8)
    return found


def bake_canopy_sky(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """What each voxel sees of the sky through the canopy.

    Args:
        inputs: `pattern`, with `colour_1`, of twice the voxels' length.

    Returns:
        `seen` uint8 (K, J, I, 4), packed: the integrals over the upper hemisphere of the transmittance V / 2 pi and of
        V w / pi, w the direction; 1 and (0, 0, 1) where nothing hides the sky. Of several sections, one above the
        other.
    """

    def one(alpha: np.ndarray, tell: Callable[[float], None]) -> np.ndarray:
        return packed(_sky_through(alpha, tell))

    words = "looking at the sky through the canopy"
    return {"seen": each_section(opacities(inputs["pattern"], 1), one, lambda share: progress(share, words))}


def _sky_through(alpha: np.ndarray, progress: Callable[[float], None]) -> np.ndarray:
    """Moments (K, J, I, 4) of the sky that each voxel of opacity (K, J, I) uint8 sees."""
    extinction, voxel = extinction_of(alpha)
    rays, shares = directions()
    seen = np.zeros((*extinction.shape, 4), np.float32)

    def one(number: int) -> np.ndarray:
        x, y, z = rays[number]
        return transmittance(extinction, voxel, math.atan2(x, y), math.asin(z))

    with ThreadPoolExecutor(2) as pool:
        for number, through in enumerate(pool.map(one, range(len(rays)))):
            for channel, factor in enumerate((1.0, *(2 * rays[number]))):
                seen[..., channel] += np.float32(shares[number] * factor) * through
            progress(number / len(rays))
    return seen


def bake_land_sky(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """What each node of the ground, or its treetops, sees of the sky over land and stands.

    Args:
        inputs: `terrain`, with `surface` (N, N) [m].

    Returns:
        `seen` uint8 (N, N, 4), packed, as of the canopy, with visibility 1 above the horizon and 0 below; row 0 is the
        northern edge.

    Source: Dozier and Frew 1990, eq. 7 (integrals over the sky above a horizon), here by direction.
    """
    heights = np.ascontiguousarray(inputs["terrain"]["surface"], np.float64)
    seen = np.zeros((*heights.shape, 4))
    azimuths = [2 * math.pi * number / AZIMUTHS for number in range(AZIMUTHS)]
    for number, slopes in sweeps(heights, (CELL, CELL), azimuths):
        progress(number / AZIMUTHS, "sweeping the horizon")
        horizon = np.arctan(np.maximum(slopes, 0))
        sine, cosine = np.sin(horizon), np.cos(horizon)
        # integrals over the elevation from the horizon up of cos e, cos^2 e and 2 sin e cos e
        level = 0.5 * (0.5 * math.pi - horizon - sine * cosine)
        for channel, part in enumerate((
            1 - sine, 2 * math.sin(azimuths[number]) * level, 2 * math.cos(azimuths[number]) * level, cosine**2
        )):
            seen[..., channel] += part / AZIMUTHS
    return {"seen": packed(seen)}


def canopy_sky_bake(pattern: Bake) -> Bake:
    """What the voxels see of the sky."""
    return Bake("canopy_sky", bake_canopy_sky, {}, (pattern,), seconds=3)


def land_sky_bake(terrain: Bake) -> Bake:
    """What the ground's nodes see of the sky."""
    return Bake("land_sky", bake_land_sky, {}, (terrain,), seconds=2)
