"""Rings: which cell is where, in the shader as in numpy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.clouds.basis.solid_angle import SolidAngleBasis
from renderer.clouds.radiosity.bases import GRID
from tests.clouds.basis.conftest import Evaluated, cell_middles

RINGS = SolidAngleBasis().chosen(64, np.zeros((0, GRID, GRID)))
CHANCE = np.random.default_rng(2).random((3, 64))


def error(evaluated: Evaluated) -> float:
    ground, cloud = evaluated(SolidAngleBasis(), RINGS, CHANCE, 1 - CHANCE, cell_middles())
    exact = np.moveaxis(RINGS.synthesise(CHANCE), 0, -1).reshape(-1, 3)
    return float(max(np.abs(ground - exact).max(), np.abs(cloud - 1 + exact).max()))


def test_the_shader_finds_the_cell(evaluated: Evaluated) -> None:
    assert error(evaluated) < 1e-6


def test_a_wrong_cell_is_found(evaluated: Evaluated, spoil: Callable) -> None:
    with spoil("clouds/basis/solid_angle.glsl", "(at * 0.5 + 0.5) * vec2(size)", "(at * 0.5 + 0.5) * vec2(size) + 1.0"):
        assert error(evaluated) > 0.1
    with spoil("clouds/basis/solid_angle.glsl", ".r + 0.5)", ".r - 0.5)"):
        assert error(evaluated) > 0.1


def test_the_lower_the_point_the_finer_the_middle() -> None:
    low, high = (SolidAngleBasis(centre_height=h).chosen(64, np.zeros((0, GRID, GRID))) for h in (4.0, 16.0))
    middle = (GRID // 2, GRID // 2)
    assert low.sizes[low.labels[middle]] < high.sizes[high.labels[middle]]
    assert low.sizes[low.labels[0, 0]] > high.sizes[high.labels[0, 0]]
