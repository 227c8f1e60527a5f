"""The overcast sky: the standard's closed forms, and how much of the clear sky's light is left."""

from __future__ import annotations

import math

import numpy as np
import pytest

from renderer.world.overcast import LEFT
from renderer.world.sky import bake_sky, metered_light, sky_for, sky_moments, sky_radiance

Tables = dict[str, np.ndarray]


def quiet(share: float, words: str) -> None:
    """Progress nobody asks for."""


@pytest.fixture(scope="module")
def clear() -> Tables:
    return bake_sky({}, {}, quiet)


@pytest.fixture(scope="module")
def closed() -> Tables:
    return bake_sky({"weather": "overcast"}, {}, quiet)


@pytest.mark.parametrize("degrees", [3.0, 40.0, 85.0])
def test_the_zenith_is_three_times_as_bright_as_the_horizon(closed: Tables, degrees: float) -> None:
    """L(e) = Lz (1 + 2 sin e) / 3 in every azimuth, and 7 pi / 9 Lz on the level ground (Moon and Spencer 1942)."""
    now, sun = sky_for(closed, math.radians(degrees)), np.array([0.0, 0.6, 0.8])
    up = np.linspace(0, 1, 9)
    for azimuth in (0.0, 2.0):
        level = np.sqrt(1 - up**2)
        rays = np.stack([level * math.sin(azimuth), level * math.cos(azimuth), up], axis=1)
        found = sky_radiance(now, sun, rays)
        assert found / found[-1] == pytest.approx(np.repeat((1 + 2 * up[:, None]) / 3, 3, axis=1), rel=2e-3)
    assert now.sky_irradiance == pytest.approx(7 * math.pi / 9 * now.view[-1, 0], rel=2e-3)


@pytest.mark.parametrize("degrees", [10.0, 60.0])
def test_a_quarter_of_the_clear_skys_light_is_left(clear: Tables, closed: Tables, degrees: float) -> None:
    e = math.radians(degrees)
    open_sky, now = sky_for(clear, e), sky_for(closed, e)
    level = open_sky.sun_irradiance * math.sin(e) + open_sky.sky_irradiance
    assert now.sky_irradiance == pytest.approx(LEFT * level, rel=3e-3)
    assert not now.sun_irradiance.any()
    assert not now.disc_radiance.any()
    assert metered_light(closed, e) == pytest.approx(LEFT * metered_light(clear, e), rel=3e-3)


def test_it_has_no_side(closed: Tables) -> None:
    found = sky_moments(sky_for(closed, math.radians(30)))
    assert np.abs(found["sky_sunward"]).max() < 1e-4 * found["sky_even"].min()
    # of (1 + 2 z) / 3 the moments are closed forms
    assert found["sky_upward2"] / found["sky_even"] == pytest.approx(np.full(3, (1 / 3 + 2 / 4) / 2), rel=2e-3)


def test_nights_are_dark_and_finite_under_clouds(closed: Tables) -> None:
    night = sky_for(closed, math.radians(-30))
    assert np.isfinite(night.view).all()
    assert 0 < night.sky_irradiance.max() < 1e-4
