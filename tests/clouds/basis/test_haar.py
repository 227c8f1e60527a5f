"""Wavelets: their sum in the shader, and which are kept."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.basis.haar import HaarBasis
from renderer.clouds.radiosity.bases import GRID
from tests.clouds.basis.conftest import Evaluated, cell_middles

FIELD = np.random.default_rng(3).random((1, GRID, GRID))
CHANCE = np.random.default_rng(4).normal(size=(3, 64))
KEPT = HaarBasis().chosen(64, FIELD)
GLSL = "clouds/basis/haar.glsl"


def error(evaluated: Evaluated) -> float:
    ground, cloud = evaluated(HaarBasis(), KEPT, CHANCE, -CHANCE, cell_middles())
    exact = np.moveaxis(KEPT.synthesise(CHANCE), 0, -1).reshape(-1, 3)
    return float(max(np.abs(ground - exact).max(), np.abs(cloud + exact).max()))


def test_the_shader_sums_the_wavelets(evaluated: Evaluated) -> None:
    assert error(evaluated) < 1e-5


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("1.0 - 2.0 * step", "2.0 * step"),
        ("found += turn.y * texel", "found += turn.x * texel"),
        ("const int BASIS_LEVELS = 5", "const int BASIS_LEVELS = 4"),
        ("count - 1 + square.y", "count - 1 + square.x"),
    ],
)
def test_a_wrong_wavelet_is_found(evaluated: Evaluated, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(GLSL, right, wrong):
        assert error(evaluated) > 1e-2


def test_what_light_needs_is_kept() -> None:
    edge = np.zeros((1, GRID, GRID))
    edge[:, :, 24:] = 1
    kept = HaarBasis().chosen(15, edge)
    assert kept.n == 15
    assert kept.kept is not None
    assert kept.kept[0] == 0, "the mean"
    np.testing.assert_allclose(kept.synthesise(kept.analyse(edge)), edge, atol=1e-9)
