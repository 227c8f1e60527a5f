"""Constant sky: a tinted share of the sun's irradiance, the same under every leaf."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.sky.constant import ConstantSky
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
SHARES = np.linspace(0, 1, 9)
FILES = ["forest/matter.glsl", "forest/sky/constant.glsl"]
AROUND = "sky_light(Spot(vec3(0.0), vec3(0.0), 0.0, 1.0, ambient)).around"


def error(ask: Ask, made: ConstantSky) -> float:
    found = ask(FILES, AROUND, {"ambient": SHARES}, 3, techniques={"sky": made})
    exact = np.array(made.tint) * made.share * worlds.E_SUN
    return float(np.abs(found - exact).max())


def test_the_light_is_the_listings(ask: Ask) -> None:
    for made in (ConstantSky(), ConstantSky(tint=(1, 0.5, 0.25), share=0.7), ConstantSky(share=0)):
        assert error(ask, made) < 1e-6
    assert ConstantSky().tint == (0.3, 0.5, 0.6), "listing 10.3"
    assert ConstantSky().share == 0.3, "listing 10.1"


@pytest.mark.parametrize("wrong", ["sky_tint * sky_share * sky_irradiance", "sky_tint.bgr * sky_share * sun_irradiance",
                                   "sky_tint * (1.0 - sky_share) * sun_irradiance",
                                   "sky_tint * sky_share * sun_irradiance * spot.ambient"])
def test_a_wrong_sky_is_found(ask: Ask, spoil: Callable, wrong: str) -> None:
    with spoil("forest/sky/constant.glsl", "sky_tint * sky_share * sun_irradiance", wrong):
        assert error(ask, ConstantSky()) > 0.1


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "sky", "constant",
        MARCH,
        0.151,  # a light that knows neither the sky's colour nor what stands in its way
    )


def test_a_sky_pi_times_too_bright_is_found(judge: Judge) -> None:
    bright = {"sky": worlds.technique("sky", "constant", share=0.3 * 3.14159)}
    assert judge.distance("sky", "constant", **bright) > 1.1 * (MARCH + 0.175)


def test_picture(judge: Judge) -> None:
    judge.looks("sky", "constant")
