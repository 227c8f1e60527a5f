"""Unlit matter: its own colour times the level, put together as erratum 002-1 asks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.conftest import even

Draw = Callable[..., np.ndarray]


def radiance(draw: Draw, level: float) -> np.ndarray:
    """Colour 0.5 at an optical depth of 2."""
    block = even(1 - np.exp(-2 * 0.1 / 0.5), (0.5, 0.5, 0.5))
    return draw({"light": {"kind": "unlit", "level": level}}, block)[4, 4]


def test_an_optical_depth_of_two(draw: Draw) -> None:
    assert radiance(draw, 1.0)[:3] == pytest.approx([0.43233] * 3, abs=2e-4)


def test_the_level_is_a_factor_of_light_alone(draw: Draw) -> None:
    assert radiance(draw, 3.0) == pytest.approx([1.29699] * 3 + [0.86466], abs=5e-4)


def test_a_wrong_level_is_found(draw: Draw, spoil: Callable) -> None:
    with spoil("shells/light/unlit.glsl", "(light_level + glow)", "(1.0 + glow)"):
        assert abs(radiance(draw, 3.0)[0] - 1.297) > 0.5
