"""Blocks: how many, what the shader reads of them, and where they are too coarse."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.clouds.basis.object import ObjectBasis
from renderer.clouds.radiosity.bases import GRID, HALF
from renderer.clouds.radiosity.maps import Bounced
from renderer.clouds.radiosity.technique import InBasis, Solved
from tests.clouds.basis.conftest import Evaluated

BLOCKS = ObjectBasis().chosen(64, np.zeros((0, GRID, GRID)))
CHANCE = np.random.default_rng(1).random((3, 64))


def error(evaluated: Evaluated) -> float:
    """Worst distance at the blocks' middles."""
    middles = (np.arange(8) + 0.5) / 4 - 1
    x, y = np.meshgrid(middles, middles)
    ground, cloud = evaluated(ObjectBasis(), BLOCKS, CHANCE, 1 - CHANCE, np.stack([x.ravel(), y.ravel()], axis=-1))
    return float(max(np.abs(ground - CHANCE.T).max(), np.abs(cloud - 1 + CHANCE.T).max()))


def test_the_shader_has_each_block_at_its_middle(evaluated: Evaluated) -> None:
    assert error(evaluated) < 1e-5


def test_a_wrong_block_is_found(evaluated: Evaluated, spoil: Callable) -> None:
    with spoil("clouds/basis/object.glsl", "(basis_ground_map, at * 0.5", "(basis_ground_map, at.yx * 0.5"):
        assert error(evaluated) > 0.1


def test_blocks_show_one_number_each() -> None:
    assert ObjectBasis().chosen(15, np.zeros((0, GRID, GRID))).n == 15
    pictures = ObjectBasis().pictures(Solved(None, Bounced(CHANCE, CHANCE), InBasis(BLOCKS, CHANCE), None))  # type: ignore[arg-type]
    assert pictures["ground_map"].shape == (8, 8, 3)
    assert pictures["ground_map"][1, 2, 0] == np.float32(CHANCE[0, 10])
    assert not pictures["cloud_map"].any()


def test_a_summit_within_one_block_is_spread_over_it() -> None:
    """Errors of a bright cone of radius 4H: blocks of 8H, 4H and 2H (Belcour 2009, annex A.2)."""
    places = (np.arange(GRID) + 0.5) * 2 * HALF / GRID - HALF
    cone = np.maximum(0, 1 - np.hypot(places[:, None], places[None, :]) / 4)
    errors = []
    for count in (15, 64, 256):
        basis = ObjectBasis().chosen(count, cone[None])
        errors.append(float(np.sqrt(np.mean((basis.synthesise(basis.analyse(cone)) - cone) ** 2)) / cone.mean()))
    assert errors[0] > errors[1] > 3 > 1.5 * errors[2]
