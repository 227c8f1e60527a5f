"""Sky light by the pattern's ambient share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.sky.ambient import Ambient
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
SHARES = np.linspace(0, 1, 9)
AROUND = "sky_light(Spot(vec3(0.0), vec3(0.0), 0.0, 1.0, ambient)).around"


def error(ask: Ask) -> float:
    files = ["forest/matter.glsl", "forest/sky/ambient.glsl"]
    found = ask(files, AROUND, {"ambient": SHARES}, 3, techniques={"sky": Ambient()})
    return float(np.abs(found - SHARES[:, None] * np.array(worlds.E_SKY)).max())


def test_the_share_multiplies_the_sky(ask: Ask) -> None:
    assert error(ask) < 1e-6


@pytest.mark.parametrize("wrong", ["sky_irradiance * (1.0 - spot.ambient)", "sky_irradiance.bgr * spot.ambient",
                                   "sun_irradiance * spot.ambient", "sky_irradiance * spot.ambient * 0.318"])
def test_a_wrong_sky_is_found(ask: Ask, spoil: Callable, wrong: str) -> None:
    with spoil("forest/sky/ambient.glsl", "sky_irradiance * spot.ambient", wrong):
        assert error(ask) > 0.5


def test_a_furnace_is_even(paint: Callable[..., Any]) -> None:
    """Closed form: white matter and white ground under a sky of radiance L, all of it seen, shine with L everywhere."""
    sky = (0.5, 1.0, 2.0)
    pattern = worlds.uniform(60, albedo=1.0, ambient=255)
    baked = worlds.together(sky={**worlds.sky(sky), "sun_irradiance": np.zeros((2, 3))}, terrain=worlds.ground(),
                            pattern=pattern)
    made = worlds.state(camera=worlds.map_view(0, 0, 40), ground={"albedo": [1, 1, 1]}, **worlds.PLAIN)
    seen = paint(made, baked, (16, 16), 4).linear
    np.testing.assert_allclose(seen[..., :3], np.broadcast_to(sky, (16, 16, 3)), rtol=2e-3)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds("sky", "ambient", MARCH)  # the share is the reference's own


def test_picture(judge: Judge) -> None:
    judge.looks("sky", "ambient")
