"""What trees and land leave visible of the sky, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import expn

from renderer.forest.visible_sky import bake_canopy_sky, bake_land_sky
from renderer.forest.world_scale import CELL, NODES, VOXEL
from tests.forest import worlds


def quiet(share: float, words: str) -> None:
    """Progress nobody asks for."""


def unpacked(seen: np.ndarray) -> np.ndarray:
    return np.concatenate([seen[..., :1] / 255, seen[..., 1:3] / 127.5 - 1, seen[..., 3:] / 255], axis=-1)


def test_a_slab_is_seen_through_by_exponential_integrals() -> None:
    """Mean of exp(-t / mu) over the hemisphere is E2(t), and its part along z is 2 E3(t)."""
    seen = unpacked(bake_canopy_sky({}, {"pattern": worlds.uniform(12)}, quiet)["seen"])
    above = (np.arange(16)[::-1] + 0.5) * 20 / 16
    depth = -np.log(1 - 12 / 255) / VOXEL * above
    # four rings of directions, and bytes; the coarser level keeps the opacity of one of its own voxels
    assert seen[:, 3, 5, 0] == pytest.approx(expn(2, depth), abs=0.02)
    assert seen[:, 3, 5, 3] == pytest.approx(2 * expn(3, depth), abs=0.02)
    assert np.abs(seen[..., 1:3]).max() < 0.01


def test_an_endless_wall_hides_its_part_of_the_sky() -> None:
    """Beside a wall in the west up to the elevation a, level ground loses (1 - cos a) / 2 of an even sky."""
    surface = np.zeros((NODES, NODES))
    surface[:, : NODES // 2] = 200.0
    seen = unpacked(bake_land_sky({}, {"terrain": {"surface": surface}}, quiet)["seen"])
    steps = 10
    angle = np.arctan2(200, steps * CELL)
    here = seen[NODES // 2, NODES // 2 - 1 + steps]
    assert here[3] == pytest.approx(1 - (1 - np.cos(angle)) / 2, abs=0.01)
    assert here[0] == pytest.approx(1 - angle / np.pi, abs=0.01), "the lune between wall and horizon"
    assert here[1] == pytest.approx(np.sin(angle) / 2, abs=0.01), "more light from the east"
    assert abs(here[2]) < 0.01
    assert unpacked(bake_land_sky({}, {"terrain": {"surface": 0 * surface}}, quiet)["seen"])[9, 9] == pytest.approx(
        [1, 0, 0, 1], abs=0.004)
