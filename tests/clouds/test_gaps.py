"""What a slanting ray meets of broken clouds: low in the layer and high in it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.geometry.flat import Flat
from tests.clouds.cloud_shadow.shades import BASE, DECLARED, FILES, MAP, RADIUS, SIDE, THICKNESS

Ask = Callable[..., np.ndarray]
GAP, CLOUD = -0.25 * SIDE, 0.25 * SIDE
"""Metres east: the middles of the open and of the cloudy half of the map."""


def thickness(ask: Ask, low: list[float], high: list[float], footprint: float) -> np.ndarray:
    """Thickness that rays meet which are low in the layer at one place and high in it at another, m."""
    picture = np.zeros((64, 64, 4), np.float32)
    picture[..., 0] = picture[..., 3] = MAP
    values = {
        "planet_radius": RADIUS,
        "layer_base": BASE,
        "layer_thickness": THICKNESS,
        "cloud_drift": (0.0, 0.0),
        "cloud_side": SIDE,
        "cloud_repeats": 1.0,
        "cloud_widens": 1.0,
    }
    return ask(
        {"geometry": Flat()},
        f"cover_through(vec2(low, 0.0), vec2(high, 0.0), {footprint}).thickness",
        {"low": np.array(low), "high": np.array(high)},
        1,
        files=FILES,
        values=values,
        declarations=DECLARED,
        pictures={"cloud_map": picture, "cloud_systems": np.ones((4, 4, 4), np.float32)},
    )[..., 0]


def test_a_ray_goes_through_the_cloud_behind_a_gap(ask: Ask, spoil: Callable) -> None:
    low, high = [GAP, CLOUD, GAP, CLOUD], [GAP, GAP, CLOUD, CLOUD]
    half = THICKNESS / 2
    assert thickness(ask, low, high, 1.0) == pytest.approx([0, half, half, THICKNESS], rel=1e-3)
    with spoil("clouds/layer.glsl", "found.x = min(found.x, MIDWAY) +", "found.x = found.x + 0.0 *"):
        assert thickness(ask, low, high, 1.0) == pytest.approx([0, THICKNESS, 0, THICKNESS], rel=1e-3)
