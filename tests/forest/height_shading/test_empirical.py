"""Empirical height shading: C(h) = 0.5 + h, whatever the sun, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.height_shading.empirical import Empirical
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
FILE = "forest/height_shading/empirical.glsl"
HEIGHTS = np.linspace(0, 1, 33)


def factor(ask: Ask, made: Empirical, elevation: float = 40) -> np.ndarray:
    return ask([FILE], "height_factor(h)", {"h": HEIGHTS}, techniques={"height_shading": made},
               state=worlds.state(sun=worlds.sun(0, elevation)))[:, 0]


def error(ask: Ask) -> float:
    return float(np.abs(factor(ask, Empirical()) - (0.5 + HEIGHTS)).max())


def test_half_at_the_foot_one_and_a_half_at_the_top(ask: Ask) -> None:
    assert error(ask) < 1e-6


@pytest.mark.parametrize(("right", "wrong"), [
    ("height_shading_foot + height_shading_rise * h", "height_shading_foot - height_shading_rise * h"),
    ("height_shading_foot + height_shading_rise * h", "height_shading_foot + height_shading_rise * (1.0 - h)"),
    ("height_shading_foot + height_shading_rise * h", "height_shading_foot * height_shading_rise * h"),
])
def test_a_wrong_factor_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert error(ask) > 0.4


def test_parameters_are_the_twins(ask: Ask) -> None:
    for foot, rise, strength in ((0.2, 1.5, 1.0), (0.5, 1.0, 0.0), (1.0, 0.5, 0.4)):
        found = factor(ask, Empirical(foot=foot, rise=rise, strength=strength))
        np.testing.assert_allclose(found, 1 + strength * (foot + rise * HEIGHTS - 1), atol=1e-6)


def test_the_sun_does_not_matter(ask: Ask) -> None:
    np.testing.assert_array_equal(factor(ask, Empirical(), -10), factor(ask, Empirical(), 80))


def test_open_ground_is_left_alone(paint: Callable[..., Any]) -> None:
    """Only what stands among trees darkens: the factor belongs to the canopy."""
    seen = []
    for cover in (0.0, 1.0):
        baked = worlds.together(sky=worlds.sky(), terrain=worlds.ground(cover=cover), pattern=worlds.uniform(0))
        made = worlds.state(camera=worlds.map_view(0, 0, 20), sun=worlds.sun(0, 90),
                            **worlds.with_technique("height_shading", "empirical"))
        seen.append(float(paint(made, baked, (8, 8), 1).linear[..., 0].mean()))
    bare = worlds.GROUND[0] / np.pi * worlds.E_SUN[0]
    assert seen == pytest.approx([bare, 0.5 * bare], rel=1e-5)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "height_shading", "empirical",
        MARCH,
        0.57,  # alone in the place of every shadow: it knows no sun, no neighbour and no open ground
        against="full",
    )


def test_no_shading_at_all_is_farther_from_the_truth(judge: Judge) -> None:
    assert judge.distance("height_shading", "none", "full") > 1.1 * (MARCH + 0.47)


def test_picture(judge: Judge) -> None:
    judge.looks("height_shading", "empirical")
