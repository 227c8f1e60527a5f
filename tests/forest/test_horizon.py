"""Horizons of the land and of the canopy: sectors of sweeps, closed forms, and a plain search."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from renderer.forest.canopy_horizon import THRESHOLD, bake_canopy_horizon, solid_tops
from renderer.forest.terrain_horizon import AZIMUTHS, bake_terrain_horizon, sector_range
from renderer.forest.tiles import lattice
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL
from renderer.world.horizon_sweep import sweep as slopes


def silent(share: float, words: str) -> None:
    """Hear no progress."""


def hills(side: int = 160) -> np.ndarray:
    rng = np.random.default_rng(2)
    land = gaussian_filter(rng.standard_normal((side, side)), 8) * 1200
    return land - land.min()


def sweep(heights: np.ndarray, azimuth: float) -> np.ndarray:
    """Elevation of the horizon [rad] at every node, at least 0."""
    return np.arctan(np.maximum(slopes(heights, (CELL, CELL), azimuth), 0))


@pytest.mark.parametrize("sectors", [4, 32])
def test_sectors_take_the_highest_of_their_azimuths(sectors):
    heights = hills(96).astype(np.float32)
    baked = bake_terrain_horizon({"sectors": sectors}, {"terrain": {"surface": heights}}, silent)["sectors"]
    assert baked.shape == (sectors, 96, 96)
    assert baked.dtype == np.float32
    assert baked.min() >= 0
    for sector in (0, 1, sectors - 1):
        members = [sweep(heights, 2 * math.pi * n / AZIMUTHS) for n in sector_range(sector, sectors, AZIMUTHS)]
        np.testing.assert_allclose(baked[sector], np.max(members, axis=0), atol=1e-6)
        middle = np.array(sector_range(sector, sectors, AZIMUTHS))[len(members) // 2]
        assert middle == sector * AZIMUTHS // sectors


BLOCK = 160 / 64
"""Side [m] of a voxel of the small atlas that stands for the pattern here."""


def tower(row: int, column: int, top: int, opacity: int = 255) -> np.ndarray:
    """An atlas of air (32, 64, 64, 4) with one column of matter of `top` voxels."""
    colour = np.zeros((32, 64, 64, 4), np.uint8)
    colour[:top, row, column, 3] = opacity
    return colour


def test_a_tower_is_seen_where_it_stands_in_the_world():
    """Azimuths are the world's, though the atlas is sheared."""
    row, column, top = 30, 30, 28
    inputs = {"pattern": {"colour": tower(row, column, top)}}
    baked = bake_canopy_horizon({"sectors": 32, "heights": [1.0, 0.5]}, inputs, silent)["sectors"]
    rise = (top - 0.5) * CANOPY_HEIGHT / 32 - 0.5 * CANOPY_HEIGHT
    for step in ((-5, 0), (0, -6), (3, 4), (-3, 5), (6, -3)):
        offset = -np.array(step) @ lattice(BLOCK)
        azimuth, distance = math.atan2(*offset), math.hypot(*offset)
        seen = baked[1, :, row + step[1], column + step[0]]
        sector = round(azimuth / (2 * math.pi) * 32) % 32
        # Rays step by a voxel: the tower is met up to that much too near or too far.
        assert math.atan(rise / (distance + BLOCK)) < seen[sector] < math.atan(rise / (distance - BLOCK))
        assert seen[(sector + 16) % 32] < 0.3 * seen[sector]


def test_nothing_stands_above_the_canopy_and_thin_leaves_do_not_count():
    arguments = {"sectors": 4, "heights": [1.0, 0.5]}
    solid = bake_canopy_horizon(arguments, {"pattern": {"colour": tower(10, 10, 32)}}, silent)["sectors"]
    assert solid[0].max() == 0
    assert solid[1].max() > 1
    thin = tower(10, 10, 32, opacity=int(255 * THRESHOLD) - 1)
    assert bake_canopy_horizon(arguments, {"pattern": {"colour": thin}}, silent)["sectors"].max() == 0


def test_the_canopy_agrees_with_a_plain_search():
    rng = np.random.default_rng(4)
    colour = np.zeros((32, 64, 64, 4), np.uint8)
    tops = rng.integers(0, 31, (64, 64))
    colour[..., 3] = np.where((np.arange(32)[:, None, None] < tops) & (rng.random((64, 64)) < 0.05), 255, 0)
    arguments = {"sectors": 16, "heights": [1.0, 0.3]}
    baked = bake_canopy_horizon(arguments, {"pattern": {"colour": colour}}, silent)["sectors"][1]
    height = solid_tops(colour[..., 3] / 255, 0.625)
    to_index = np.linalg.inv(lattice(BLOCK))
    for _ in range(40):
        j, i, sector = rng.integers(64), rng.integers(64), rng.integers(16)
        best = 0.0
        for number in sector_range(int(sector), 16, 64):
            azimuth = 2 * math.pi * number / 64
            for n in range(1, 104):
                di, dj = n * BLOCK * np.array([math.sin(azimuth), math.cos(azimuth)]) @ to_index
                best = max(
                    best, (height[math.floor(j + dj + 0.5) % 64, math.floor(i + di + 0.5) % 64] - 6.0) / (n * BLOCK)
                )
        assert baked[sector, j, i] == pytest.approx(math.atan(best), abs=1e-5)
