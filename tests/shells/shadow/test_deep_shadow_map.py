"""Deep shadow map: light inside an even slab against its closed form, and a curve that is read wrongly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.shells.conftest import even
from tests.shells.shadow.slabs import THICKNESS, share, sun_share

Draw = Callable[..., np.ndarray]
DEEP: dict[str, Any] = {"kind": "deep_shadow_map", "resolution": 128, "bias": 0.0}


@pytest.mark.parametrize(("depth", "elevation"), [(1.0, 90.0), (4.0, 60.0), (0.3, 45.0)])
def test_an_even_slab(draw: Draw, depth: float, elevation: float) -> None:
    assert sun_share(draw, DEEP, depth, elevation) == pytest.approx(share(depth, elevation), abs=0.03)


def test_the_ground_lies_in_the_shadow_of_what_is_opaque(draw: Draw) -> None:
    block = even(0.0, layers=16)
    block[8:10, :, :, 3] = 0.9999
    patch = {
        "light": {"kind": "lambert"},
        "base": {"opaque": True, "colour": [1, 1, 1]},
        "sun": {"kind": "direction", "azimuth": 90.0, "elevation": 60.0},
        "camera": {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, 1], "up": [0, 1, 0], "width": 0.5},
    }
    below = draw({**patch, "base": {"opaque": False}, "shadow": DEEP}, block)[4, 4, 1]
    bright = draw({**patch, "base": {"opaque": False}, "shadow": {"kind": "none"}}, block)[4, 4, 1]
    assert below < 0.75 * bright


def acne(draw: Draw) -> float:
    """Share of a bare sphere's light that the sphere's own curve in the map takes from its lit side."""
    globe = {
        "surface": {"kind": "sphere", "radius": 0.6, "divisions": 6},
        "extrusion": {"thickness": 0.15},
        "camera": {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 1, -1], "up": [0, 0, 1], "width": 1.3},
        "sun": {"kind": "direction", "azimuth": 180.0, "elevation": 50.0},
        "base": {"opaque": True},
        "light": {"kind": "lambert"},
    }
    seen, bare = (draw({**globe, "shadow": shadow}, even(0.0), size=48) for shadow in (DEEP, {"kind": "none"}))
    return float(1 - seen[..., 1].sum() / bare[..., 1].sum())


def test_the_surface_does_not_shade_itself(draw: Draw) -> None:
    assert abs(acne(draw)) < 0.01


def test_a_surface_without_its_slope_would(draw: Draw, spoil: Callable) -> None:
    with spoil("shells/sun_walk.glsl", "/ shadow_texel + slope", "/ shadow_texel"):
        assert acne(draw) > 0.05


def behind_a_gap(draw: Draw, shadow: dict[str, Any]) -> float:
    """Light of two veils with a wide gap between them: the share of the first lies between two steps of the curve."""
    block = even(0.0, layers=32)
    block[29:31, :, :, 3] = -np.expm1(0.5 * np.log(0.79) * 32 * 0.1 / THICKNESS)
    block[6:8, :, :, 3] = 0.05
    patch = {"light": {"kind": "lambert"}, "sun": {"kind": "direction", "azimuth": 90.0, "elevation": 80.0}}
    found = draw({**patch, "shadow": shadow}, block)[3:5, 3:5, 1]
    return float(found.mean())


def test_light_behind_a_gap(draw: Draw, spoil: Callable) -> None:
    right = behind_a_gap(draw, {"kind": "sun_walk", "rate": 8.0})
    alone = {**DEEP, "close": 0}
    assert behind_a_gap(draw, alone) == pytest.approx(right, rel=0.008)
    with spoil("shells/deep_map.glsl", "first_flat + 0.01)", "first_flat - 9.0)"):
        assert abs(behind_a_gap(draw, alone) / right - 1) > 0.015


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        ("shells/deep_map.glsl", "exp(-depth) : at_surface", "1.0 - depth : at_surface"),
        ("shells/deep_map.glsl", "float t = dot(from", "float t = 0.8 * dot(from"),
        ("shells/sun_walk.glsl", "way.depth = after;", "way.depth += 0.5 * depth;"),
    ],
)
def test_a_wrong_curve_is_found(draw: Draw, spoil: Callable, file: str, right: str, wrong: str) -> None:
    with spoil(file, right, wrong):
        assert abs(sun_share(draw, DEEP, 4.0, 60.0) - share(4.0, 60.0)) > 0.05
