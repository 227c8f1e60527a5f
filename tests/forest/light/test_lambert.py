"""Lambert light: the cosine to each voxel's own normal."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.light.lambert import Lambert
from tests.forest import worlds
from tests.forest.facing import light_error
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]


def twin(voxel: np.ndarray, ground: np.ndarray, sun: np.ndarray) -> np.ndarray:
    return np.maximum(voxel @ sun, 0)


def test_the_factor_is_the_cosine(ask: Ask) -> None:
    assert light_error(ask, Lambert(), twin) < 1e-5


@pytest.mark.parametrize(("right", "wrong"), [
    ("max(dot(voxel_normal, sun_direction), 0.0)", "max(-dot(voxel_normal, sun_direction), 0.0)"),
    ("dot(voxel_normal, sun_direction)", "dot(voxel_normal.yxz, sun_direction)"),
    ("dot(voxel_normal, sun_direction)", "dot(ground_normal, sun_direction)"),
    ("max(dot(voxel_normal, sun_direction), 0.0)", "max(dot(voxel_normal, sun_direction), 0.0) * 3.14159265"),
])
def test_a_wrong_factor_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/light/lambert.glsl", right, wrong):
        assert light_error(ask, Lambert(), twin) > 0.1


def brightness(paint: Callable[..., Any], normal: tuple[int, int, int], azimuth: float, elevation: float) -> float:
    """Red radiance of an opaque canopy whose voxels all face one way, seen from above."""
    pattern = worlds.uniform(255, albedo=0.4)
    pattern["normal"][..., :3] = normal
    baked = worlds.together(sky=worlds.sky(), terrain=worlds.ground(), pattern=pattern)
    made = worlds.state(camera=worlds.map_view(0, 0, 20), sun=worlds.sun(azimuth, elevation), **worlds.PLAIN)
    return float(paint(made, baked, (16, 16), 8).linear[..., 0].mean())


def test_an_opaque_canopy_reflects_its_albedo_over_pi(paint: Callable[..., Any]) -> None:
    """Closed form: albedo / pi E_sun n.s, the normal in WORLD axes: east is +x, whichever way the tile lies."""
    east, level = (255, 128, 128), 102 / 255 / np.pi * worlds.E_SUN[0]
    assert brightness(paint, worlds.UP, 20, 90) == pytest.approx(level, rel=1e-3)
    assert brightness(paint, worlds.UP, 20, 30) == pytest.approx(level / 2, rel=0.01)
    assert brightness(paint, east, 90, 30) == pytest.approx(level * np.cos(np.radians(30)), rel=0.01)
    assert brightness(paint, east, 270, 30) == pytest.approx(0, abs=1e-3)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds("light", "lambert", MARCH)  # the light is the reference's own


def test_picture(judge: Judge) -> None:
    judge.looks("light", "lambert")
