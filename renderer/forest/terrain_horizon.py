"""Terrain horizons over the whole square, by exact hull sweeps along every azimuth."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.forest.world_scale import CELL
from renderer.world.horizon_sweep import sweeps

AZIMUTHS = 128
"""Directions swept; each sector takes those inside it and on its two borders."""


def sector_range(sector: int, sectors: int, azimuths: int) -> np.ndarray:
    """Numbers of the azimuths inside a sector or on its borders; sector k's axis is azimuth k * azimuths /
    sectors."""
    half = azimuths // sectors // 2
    middle = sector * azimuths // sectors
    return np.arange(middle - half, middle + half + 1) % azimuths


def bake_terrain_horizon(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """Smallest elevation above which every direction of a sector is clear of the land and its stands.

    The sweep runs over the stands' tops: between two wooded points that is the terrain's own horizon, and a glade sees
    the forest's edge around it, which the canopy's own horizon over the tile cannot know.

    Args:
        arguments: `sectors`, 4 to 32. inputs: `terrain`, with `surface` (N, N) [m].

    Returns:
        `sectors` float32 [chi, N, N] [rad], from the horizontal; sector k is centred at azimuth 2 pi k / chi from
        north. At least 0: beyond the edge, and where nothing rises, an infinite plane continues the land.

    Source: Cohen 2004, section 3.1, phi_min; formulas i for the sweep in place of his cube maps.
    """
    heights = np.ascontiguousarray(inputs["terrain"]["surface"], np.float64)
    sectors = int(arguments["sectors"])
    result = np.zeros((sectors, *heights.shape), np.float32)
    owners: list[list[int]] = [[] for _ in range(AZIMUTHS)]
    for sector in range(sectors):
        for number in sector_range(sector, sectors, AZIMUTHS):
            owners[number].append(sector)
    azimuths = [2 * math.pi * number / AZIMUTHS for number in range(AZIMUTHS)]
    for number, slopes in sweeps(heights, (CELL, CELL), azimuths):
        progress(number / AZIMUTHS, "sweeping the horizon")
        for sector in owners[number]:
            np.maximum(result[sector], slopes, out=result[sector])
    return {"sectors": np.arctan(result, out=result)}
