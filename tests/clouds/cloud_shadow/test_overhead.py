"""The shadow painted straight down: its closed form, and that it knows no azimuth."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.cloud_shadow.overhead import Overhead
from tests.clouds.cloud_shadow.shades import EXTINCTION, THICKNESS, shade

Ask = Callable[..., np.ndarray]
EAST = np.array([-2000.0, 2000.0])
DEPTH = EXTINCTION * THICKNESS


@pytest.mark.parametrize("elevation", [90.0, 40.0, 20.0])
def test_beer_s_law_under_the_cloud(ask: Ask, elevation: float) -> None:
    exact = np.array([1.0, np.exp(-DEPTH / np.sin(np.radians(elevation)))])
    assert shade(ask, Overhead(), EAST, elevation, "direct") == pytest.approx(exact, rel=1e-3)


def test_light_is_conserved(ask: Ask) -> None:
    """What a layer does not send back comes down, direct or scattered: never more than all."""
    whole = shade(ask, Overhead(), EAST, 40.0, "direct") + shade(ask, Overhead(), EAST, 40.0, "diffuse")
    assert whole[0] == pytest.approx(1.0, abs=1e-6)
    assert 0.5 < whole[1] < 1.0


def test_it_does_not_move_with_the_sun(ask: Ask) -> None:
    east, west = (shade(ask, Overhead(), EAST, 20.0, "direct", azimuth) for azimuth in (90.0, 270.0))
    assert east == pytest.approx(west)


def test_twice_the_depth_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil("clouds/shade.glsl", "before = layer_extinction * crossed", "before = 2.0 * layer_extinction * crossed"):
        found = shade(ask, Overhead(), EAST, 40.0, "direct")
    assert abs(found[1] / np.exp(-DEPTH / np.sin(np.radians(40.0))) - 1) > 0.5
