"""Lambert light: the cosine to each voxel's own normal."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.light.lambert import Lambert
from tests.forest import worlds
from tests.forest.facing import Leaves, light_error
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]


def twin(leaves: Leaves, sun: np.ndarray) -> np.ndarray:
    return leaves.albedo / np.pi * np.maximum(leaves.normal @ sun, 0)[:, None]


def test_the_light_goes_with_the_cosine(ask: Ask) -> None:
    assert light_error(ask, Lambert(), twin) < 1e-6


@pytest.mark.parametrize(("right", "wrong"), [
    ("max(dot(matter.normal, sun_direction), 0.0)", "max(-dot(matter.normal, sun_direction), 0.0)"),
    ("dot(matter.normal, sun_direction)", "dot(matter.normal.yxz, sun_direction)"),
    ("dot(matter.normal, sun_direction)", "dot(matter.slope, sun_direction)"),
    ("matter.albedo * INVERSE_PI", "matter.albedo"),
    ("matter.albedo * INVERSE_PI", "matter.passed * INVERSE_PI"),
])
def test_a_wrong_light_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/light/lambert.glsl", right, wrong):
        assert light_error(ask, Lambert(), twin) > 0.05


def brightness(paint: Callable[..., Any], normal: tuple[int, int, int], azimuth: float, elevation: float) -> float:
    """Red radiance of an opaque canopy whose voxels all face one way, seen from above."""
    pattern = worlds.uniform(255, albedo=0.4)
    pattern["normal"][..., :3] = normal
    baked = worlds.together(sky=worlds.sky(), terrain=worlds.ground(), pattern=pattern)
    plain = worlds.with_technique("light", "lambert")
    made = worlds.state(camera=worlds.map_view(0, 0, 20), sun=worlds.sun(azimuth, elevation), **plain)
    return float(paint(made, baked, (16, 16), 8).linear[..., 0].mean())


def test_an_opaque_canopy_reflects_its_albedo_over_pi(paint: Callable[..., Any]) -> None:
    """Closed form: albedo / pi E_sun n.s, the normal in WORLD axes: east is +x, whichever way the tile lies."""
    east, level = (255, 128, 128), 102 / 255 / np.pi * worlds.E_SUN[0]
    assert brightness(paint, worlds.UP, 20, 90) == pytest.approx(level, rel=1e-3)
    assert brightness(paint, worlds.UP, 20, 30) == pytest.approx(level / 2, rel=0.01)
    assert brightness(paint, east, 90, 30) == pytest.approx(level * np.cos(np.radians(30)), rel=0.01)
    assert brightness(paint, east, 270, 30) == pytest.approx(0, abs=1e-3)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "light", "lambert",
        MARCH,
        0.156,  # leaves let no light through, and all of a voxel's lie alike
    )


def test_lambert_is_told_from_the_leaves_own_light(judge: Judge) -> None:
    assert judge.distance("light", "lambert") > 3 * MARCH


def test_picture(judge: Judge) -> None:
    judge.looks("light", "lambert")
