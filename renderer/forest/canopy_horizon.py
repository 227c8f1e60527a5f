"""Canopy horizons over the tile: how high the trees stand around each column of the pattern."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numba import njit

from renderer.core.technique import Arrays
from renderer.forest.species_alone import each_section, opacities
from renderer.forest.terrain_horizon import sector_range
from renderer.forest.tiles import RHOMBI, lattice
from renderer.forest.world_scale import CANOPY_HEIGHT, TILE_SIDE

AZIMUTHS = 64
"""Directions searched; each sector takes those inside it and on its two borders."""

THRESHOLD = 0.3
"""Opacity from which a voxel counts as solid, so that shadows start inside the crowns (Cohen 2004, section 5.1)."""

REACH = 260.0
"""Distance [m] searched, round the torus of the atlas."""


@njit(cache=True, nogil=True)
def _search(tops, probe, direction, step, reach, result):
    """Highest slope of the canopy from every column along one direction.

    Args:
        tops: (J, I) height [m] of the highest solid voxel, far below the ground where there is none; periodic.
        probe: height [m] of the eye.
        direction: (2,) voxels (i, j) a step. step: its length [m]. reach: [m]. result: slopes (J, I) float32, raised
        in place.
    """
    rows, columns = tops.shape
    highest = max(tops.max() - probe, 0.0)
    steps = int(reach / step)
    for j in range(rows):
        for i in range(columns):
            best = result[j, i]
            for n in range(1, steps + 1):
                along = n * step
                # Beyond this distance not even the tallest tree can change the answer.
                if best * along >= highest:
                    break
                row = math.floor(j + n * direction[1] + 0.5) % rows
                column = math.floor(i + n * direction[0] + 0.5) % columns
                slope = (tops[row, column] - probe) / along
                if slope > best:
                    best = np.float32(slope)
            result[j, i] = best


def solid_tops(opacity: np.ndarray, layer: float) -> np.ndarray:
    """Height [m] of the centre of the highest voxel above the threshold in each column of (K, J, I); -1000 where
    there is none."""
    solid = opacity > THRESHOLD
    highest = len(solid) - 1 - solid[::-1].argmax(axis=0)
    return np.where(solid.any(axis=0), (highest + 0.5) * layer, -1000.0)


def bake_canopy_horizon(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """Smallest elevation above which every direction of a sector is clear of the canopy, at each height.

    Args:
        arguments: `sectors`, 4 to 32; `heights`, of the probes, as shares of the canopy's height.
        inputs: `pattern`, with `colour`.

    Returns:
        `sectors` float32 [heights, chi, J, I] [rad] from the horizontal, row j along v, column i along u; sector k is
        centred at WORLD azimuth 2 pi k / chi from north. At least 0, for the canopy goes on without end. Of several
        sections, the heights of one after those of the other.

    Source: Cohen 2004, section 3.1. The neighbours are those of the atlas; on the map they are others of the same
    make.
    """
    sectors, heights = int(arguments["sectors"]), [float(height) for height in arguments["heights"]]

    def one(alpha: np.ndarray, tell: Callable[[float], None]) -> np.ndarray:
        return _horizons(alpha, sectors, heights, tell)

    words = "searching the canopy's horizon"
    return {"sectors": each_section(opacities(inputs["pattern"]), one, lambda share: progress(share, words))}


def _horizons(alpha: np.ndarray, sectors: int, heights: list[float], progress: Callable[[float], None]) -> np.ndarray:
    """The horizons [heights, chi, J, I] [rad] of a canopy of opacity (K, J, I) uint8."""
    opacity = alpha.astype(np.float32) / np.float32(255)
    tops = solid_tops(opacity, CANOPY_HEIGHT / len(opacity))
    voxel = TILE_SIDE * RHOMBI / tops.shape[1]
    to_index = np.linalg.inv(lattice(voxel))
    result = np.zeros((len(heights), sectors, *tops.shape), np.float32)

    def one(job: tuple[int, int]) -> tuple[int, int, np.ndarray]:
        level, number = job
        probe = CANOPY_HEIGHT * heights[level]
        azimuth = 2 * math.pi * number / AZIMUTHS
        slopes = np.zeros(tops.shape, np.float32)
        _search(tops, probe, np.array([math.sin(azimuth), math.cos(azimuth)]) * voxel @ to_index, voxel, REACH, slopes)
        return level, number, slopes

    jobs = [(level, number) for level in range(len(heights)) for number in range(AZIMUTHS)]
    members = [set(sector_range(sector, sectors, AZIMUTHS).tolist()) for sector in range(sectors)]
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        for done, (level, number, slopes) in enumerate(pool.map(one, jobs)):
            progress(done / len(jobs))
            for sector in range(sectors):
                if number in members[sector]:
                    np.maximum(result[level, sector], slopes, out=result[level, sector])
    return np.arctan(result, out=result)
