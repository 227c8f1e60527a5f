"""Depth shadow map: where shadows end, how texels are compared and snapped, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.shadow.depth_shadow_map import DepthShadowMap
from tests.forest import worlds
from tests.forest.shadow.banks import bank, edge_error, far_side_is_lit, holds_cost, lit, stands_still_when_snapped
from tests.forest.truth import Judge

Paint = Callable[..., Any]
Ask = Callable[..., np.ndarray]
KIND = "depth_shadow_map"
FIXED = {"resolution": 1024, "threshold": 0.3, "bias": 0.3, "texel_bias": 0.25}
"""Pinned, so that a tuned default leaves the measured cost alone."""
COST = 0.095
"""Light arrives wholly or not at all; bias; texels without a filter."""
PASS = "forest/shadow/depth_shadow_map_depth.glsl"
FRAME = "forest/shadow/depth_shadow_map.glsl"
WALK = "forest/sun_walk.glsl"


@pytest.mark.parametrize("elevation", [25.0, 30.0])
def test_a_brinks_shadow_ends_where_geometry_says(paint: Paint, elevation: float) -> None:
    # A texel of the window (44 m / 512), and half a pixel.
    assert edge_error(paint, KIND, elevation) < 0.1 / np.sin(np.radians(elevation)) + 0.13


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        (FRAME, "/ shadow_window.zw;", "/ shadow_window.zw * 0.98;"),
        (PASS, "shadow_window.xy + pixel", "shadow_window.xy + 0.98 * pixel"),
        (WALK, "return found == 0 ? NEVER : begin - met;", "return found == 0 ? NEVER : begin - met + 30.0;"),
    ],
)
def test_a_wrong_shadow_is_found(paint: Paint, spoil: Callable, file: str, right: str, wrong: str) -> None:
    with spoil(file, right, wrong):
        # Another sun each time, because the map that other tests drew is still at hand.
        assert edge_error(paint, KIND, 30.001 + len(wrong) * 1e-4) > 0.5


def test_a_sun_from_the_other_side_lights_the_foot_of_the_bank(paint: Paint) -> None:
    far_side_is_lit(paint, KIND)


def test_a_slope_does_not_shade_itself(paint: Paint) -> None:
    """A plane under a sun 10 degrees high, texels of 2 m, hardly a bias: off a texel's centre it is lit, too."""
    x = (np.arange(512) - 255.5) * 8
    plane = worlds.together(
        sky=worlds.sky(),
        terrain=worlds.ground(0.3 * np.clip(800 - x, 0, 1600)[None, :], 0.0),
        pattern=worlds.uniform(0),
    )
    wide = {"camera": worlds.map_view(0, 0, 900), "sun": worlds.sun(90, 10)}
    none, shaded = (
        paint(worlds.state(**wide, **worlds.with_technique("shadow", kind, **given)), plane, (96, 96), 1)
        for kind, given in (("none", {}), (KIND, {"resolution": 512, "bias": 0.15, "texel_bias": 0.0}))
    )
    np.testing.assert_allclose(shaded.linear[8:-8, 8:-8, 0], none.linear[8:-8, 8:-8, 0], rtol=1e-3)


def test_a_slope_that_is_not_followed_shades_itself(paint: Paint, spoil: Callable) -> None:
    with spoil(FRAME, "sunward + dot(slope, centre - line)", "sunward"), pytest.raises(AssertionError):
        test_a_slope_does_not_shade_itself(paint)


@pytest.mark.parametrize("filtered", [False, True])
def test_texels_are_compared_one_by_one(ask: Ask, filtered: bool) -> None:
    """Twin: lit where the point is no farther behind than the bias, the four nearest blended if asked; outside it
    nothing is known to shade."""
    rng = np.random.default_rng(3)
    made = DepthShadowMap(bias=2.0, texel_bias=0.1, strength=0.8, filtered=filtered)
    first = rng.uniform(30, 60, (4, 4)).astype(np.float32)
    position = rng.uniform((-60, -60, 0), (60, 60, 90), (400, 3)).astype(np.float32)
    window = {
        "shadow_window": (-50.0, -50.0, 25.0, 25.0),
        "shadow_right": (1.0, 0.0, 0.0),
        "shadow_up": (0.0, 1.0, 0.0),
    }
    found = ask(
        [FRAME],
        "shadow_visibility(position, 0.0, vec2(0.0))",
        {"position": position},
        state=worlds.state(sun=worlds.sun(0, 90)),
        techniques={"shadow": made},
        textures={"shadow_depth": first},
        values=window,
        declarations=f"#define SHADOW_FILTERED {int(filtered)}",
    )[:, 0]
    place = (position[:, :2].astype(np.float64) + 50) / 25

    def shares(texel: np.ndarray) -> np.ndarray:
        column, row = np.clip(texel, 0, 3).astype(int).T
        return (position[:, 2] >= first[row, column] - 4.5).astype(float)

    if filtered:
        low, f = np.floor(place - 0.5), (place - 0.5) % 1
        corners = [shares(low + step) for step in ((0, 0), (1, 0), (0, 1), (1, 1))]
        rows = [corners[k] * (1 - f[:, 0]) + corners[k + 1] * f[:, 0] for k in (0, 2)]
        exact = rows[0] * (1 - f[:, 1]) + rows[1] * f[:, 1]
    else:
        exact = shares(np.floor(place))
    inside = ((place >= 0) & (place <= 4)).all(axis=1)
    np.testing.assert_allclose(found, np.where(inside, 0.2 + 0.8 * exact, 1.0), atol=1e-4)
    assert 0.2 < exact[inside].mean() < 0.8


def test_no_sun_below_the_horizon_and_no_shadow_without_strength(paint: Paint) -> None:
    made = worlds.state(
        camera=worlds.map_view(26, 0, 24),
        sun=worlds.sun(270, -3),
        **worlds.with_technique("shadow", KIND, resolution=512),
    )
    assert paint(made, bank(), (16, 16), 1).linear[..., :3].max() < 1e-6
    np.testing.assert_allclose(lit(paint, bank(), worlds.sun(270, 30), 26.0, KIND, strength=0.0), 1, atol=1e-3)


def test_only_a_snapped_map_keeps_its_texels_while_the_camera_moves() -> None:
    stands_still_when_snapped(DepthShadowMap)


def test_distance_to_the_reference(judge: Judge) -> None:
    holds_cost(judge, KIND, COST, FIXED)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", KIND)
