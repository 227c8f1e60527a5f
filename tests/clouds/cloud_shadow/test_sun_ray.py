"""The shadow along the sun's ray: where ray and plane meet, Beer's law there, and a shadow on the wrong side."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.cloud_shadow.sun_ray import SunRay
from tests.clouds.cloud_shadow.shades import BASE, EXTINCTION, SIDE, THICKNESS, shade

Ask = Callable[..., np.ndarray]
EAST = np.linspace(-3500.0, 3500.0, 57)
TEXEL = SIDE / 64


def exact(elevation: float) -> tuple[np.ndarray, np.ndarray]:
    """The direct share by ray and plane, and which places lie a texel and more from the cloud's edges."""
    met = EAST + (BASE + THICKNESS / 2) / np.tan(np.radians(elevation))
    edge = np.abs((met + SIDE / 4) % (SIDE / 2) - SIDE / 4)
    cloudy = (met + SIDE / 2) % SIDE > SIDE / 2
    return np.where(cloudy, np.exp(-EXTINCTION * THICKNESS / np.sin(np.radians(elevation))), 1.0), edge > TEXEL


def error(ask: Ask, elevation: float) -> float:
    truth, clear = exact(elevation)
    return float(np.abs(shade(ask, SunRay(), EAST, elevation, "direct") - truth)[clear].max())


@pytest.mark.parametrize("elevation", [90.0, 45.0, 20.0])
def test_ray_and_plane(ask: Ask, elevation: float) -> None:
    assert error(ask, elevation) < 2e-3


def test_scattered_light_comes_from_overhead(ask: Ask) -> None:
    found = shade(ask, SunRay(), np.array([-2000.0, 2000.0]), 45.0, "diffuse")
    assert found[0] < 1e-3 < found[1]


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("point + way * sun_direction", "point - way * sun_direction"),
        ("max(layer_base + 0.5 * layer_thickness - altitude, 0.0)", "max(0.5 * layer_base - altitude, 0.0)"),
    ],
)
def test_a_shadow_in_the_wrong_place_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("clouds/cloud_shadow/sun_ray.glsl", right, wrong):
        assert error(ask, 45.0) > 0.3
