"""Cascaded shadow maps: slices of the view, the finest window that holds a point, and the distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.shadow.cascaded_shadow_map import MOST, CascadedShadowMap, splits
from renderer.forest.sun_view import depths
from tests.forest import worlds
from tests.forest.shadow.banks import edge_error, far_side_is_lit, holds_cost
from tests.forest.truth import Judge

Paint = Callable[..., Any]
Ask = Callable[..., np.ndarray]
KIND = "cascaded_shadow_map"
FIXED = {"resolution": 512, "cascades": 3, "threshold": 0.2, "bias": 0.0, "texel_bias": 0.0, "fade": 1.0}
"""Pinned, so that a tuned default leaves the measured cost alone."""
COST = 0.067
"""One depth a texel, and light that fades behind it the same everywhere."""
PASS = "forest/shadow/cascaded_shadow_map_depth.glsl"
FRAME = "forest/shadow/cascaded_shadow_map.glsl"
FAR_VIEW = {"kind": "look", "eye": [0, -100, 60], "target": [0, 300, 0], "field_of_view": 40}


def test_slices_meet_between_equal_widths_and_equal_ratios() -> None:
    np.testing.assert_allclose(splits(10, 1000, 2, 1.0), [10, 100, 1000])
    np.testing.assert_allclose(splits(10, 1000, 3, 0.0), [10, 340, 670, 1000])
    np.testing.assert_allclose(splits(10, 1000, 2, 0.5), [10, 302.5, 1000])
    behind = splits(-5, 1000, 4, 1.0)
    assert behind[0] == -5
    assert (np.diff(behind) > 0).all()
    assert behind[1] > 10, "a ratio to nothing would spend every slice on the nearest metres"


@pytest.mark.parametrize("elevation", [25.0, 30.0])
def test_a_brinks_shadow_ends_where_geometry_says(paint: Paint, elevation: float) -> None:
    # A texel of the window (70 m / 512, a quarter of an octave coarser), and half a pixel.
    assert edge_error(paint, KIND, elevation) < 0.17 / np.sin(np.radians(elevation)) + 0.13


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        (FRAME, "(line - window.xy) / window.zw", "(line - window.xy) / window.wz * 1.1"),
        (PASS, "* window.zw;", "* window.zw * 0.9;"),
        (PASS, "floor(pixel.y / shadow_resolution)", "1.0"),
    ],
)
def test_a_wrong_shadow_is_found(paint: Paint, spoil: Callable, file: str, right: str, wrong: str) -> None:
    with spoil(file, right, wrong):
        # Another sun each time, because the map that other tests drew is still at hand.
        assert edge_error(paint, KIND, 30.001 + len(wrong) * 1e-4) > 0.5


def test_a_sun_from_the_other_side_lights_the_foot_of_the_bank(paint: Paint) -> None:
    far_side_is_lit(paint, KIND)


@pytest.mark.parametrize("filtered", [False, True])
def test_a_point_takes_the_finest_window_that_holds_it(ask: Ask, filtered: bool) -> None:
    """Twin: nested windows of 20, 40 and 80 m with one depth each; beyond them nothing is known to shade."""
    rng = np.random.default_rng(3)
    made = CascadedShadowMap(bias=1.0, texel_bias=0.0, strength=0.9, fade=3.0, filtered=filtered)
    sides = np.array([20.0, 40.0, 80.0])
    first = np.array([30.0, 40.0, 50.0])
    windows = [(-s / 2, -s / 2, s / 8, s / 8) for s in (*sides, 80.0)]
    position = rng.uniform((-50, -50, 20), (50, 50, 60), (600, 3)).astype(np.float32)
    found = ask(
        [FRAME],
        "shadow_visibility(position, 0.0, vec2(0.0))",
        {"position": position},
        state=worlds.state(sun=worlds.sun(0, 90)),
        techniques={"shadow": made},
        textures={"shadow_depth": np.repeat(first, 8)[:, None] + np.zeros((1, 8))},
        values={"shadow_windows": windows, "shadow_right": (1.0, 0.0, 0.0), "shadow_up": (0.0, 1.0, 0.0)},
        declarations=f"#define SHADOW_FILTERED {int(filtered)}\n#define SHADOW_CASCADES 3",
    )[:, 0]
    away = np.abs(position[:, :2]).max(axis=1)
    held = away[:, None] < sides / 2 - sides / 16  # half a texel inside
    exact = np.ones(len(position))
    for k in (2, 1, 0):
        soft = np.exp(-np.maximum(first[k] - 1 - position[:, 2], 0) / 3)
        exact = np.where(held[:, k], 0.1 + 0.9 * soft, exact)
    clear = (np.abs(away[:, None] - (sides / 2 - sides / 16)) > 1e-3).all(axis=1)
    np.testing.assert_allclose(found[clear], exact[clear], atol=2e-4)
    assert exact.min() < 0.2


def test_every_slice_lies_in_its_window() -> None:
    made = CascadedShadowMap(cascades=3)
    state = worlds.state(camera=FAR_VIEW, sun=worlds.sun(140, 35))
    baked = {"terrain": worlds.ground()}
    windows = np.array(made.windows(state, baked, (64, 64)))
    assert len(windows) == MOST
    points = made.seen(state, baked, (64, 64))
    across = made.light(state, baked).across(points)
    depth = depths(state.camera, points)
    limits = splits(depth.min(), depth.max(), 3, made.split)
    for window, near, far in zip(windows, limits[:-1], limits[1:], strict=False):
        place = (across[(depth >= near) & (depth <= far)] - window[:2]) / window[2:] / made.resolution
        assert len(place)
        assert 0 <= place.min() <= place.max() <= 1
    assert (windows[2, 2:] > 2 * windows[0, 2:]).all(), "far texels are coarser"


def test_texels_stand_still_while_the_camera_moves() -> None:
    def grid(y: float) -> np.ndarray:
        state = worlds.state(camera={**FAR_VIEW, "eye": [0, y, 60]}, sun=worlds.sun(140, 35))
        low, side = np.split(np.array(made.windows(state, {"terrain": worlds.ground()}, (64, 64))), 2, axis=1)
        return np.asarray((low / side) % 1)

    made = CascadedShadowMap()
    np.testing.assert_allclose(grid(-100.0), grid(-100.7), atol=1e-9)
    made = CascadedShadowMap(snapping=False)
    assert np.abs(grid(-100.0) - grid(-100.7)).max() > 0.01


def test_distance_to_the_reference(judge: Judge) -> None:
    holds_cost(judge, KIND, COST, FIXED)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", KIND)
