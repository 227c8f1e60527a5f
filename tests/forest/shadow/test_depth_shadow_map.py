"""Depth shadow map: where shadows end, which opacities cast them, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.shadow.depth_shadow_map import DepthShadowMap
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Paint = Callable[..., Any]
Ask = Callable[..., np.ndarray]
HEIGHT = 24.0
PASS = "forest/shadow/depth_shadow_map_depth.glsl"
FRAME = "forest/shadow/depth_shadow_map.glsl"


def lit(paint: Paint, baked: Any, sun: dict[str, Any], x: float, **shadow: Any) -> np.ndarray:
    """Share of the sun on 96 places, 0.25 m apart, around x, of level bare ground seen from above."""
    chosen = worlds.with_technique("shadow", "depth_shadow_map", **{"resolution": 512, **shadow})
    made = worlds.state(camera=worlds.map_view(x, 0.0, 24.0), sun=sun, **chosen)
    light = paint(made, baked, (96, 96), 1).linear[48, :, 0]
    return light / (worlds.GROUND[0] / np.pi * worlds.E_SUN[0] * np.sin(np.radians(sun["elevation"])))


def bank() -> Any:
    """A plateau in the west that ends at x = -20 and falls at 45 degrees to level ground at x = 4."""
    x = (np.arange(512) - 255.5) * 8
    return worlds.together(sky=worlds.sky(), terrain=worlds.ground(np.clip(4 - x, 0, HEIGHT)[None, :], 0.0),
                           pattern=worlds.uniform(0))


def edge_error(paint: Paint, elevation: float = 30.0, **shadow: Any) -> float:
    """How far the shadow's end lies from the brink's x + height / tan(elevation) [m]."""
    exact = -20 + HEIGHT / np.tan(np.radians(elevation))
    shares = lit(paint, bank(), worlds.sun(270, elevation), exact, **shadow)
    x = exact + (np.arange(96) + 0.5 - 48) * 0.25
    dark = x[shares < 0.5]
    return abs(float(dark.max() if len(dark) else x[0]) + 0.125 - exact)


@pytest.mark.parametrize("elevation", [25.0, 30.0])
def test_a_brinks_shadow_ends_where_geometry_says(paint: Paint, elevation: float) -> None:
    # A texel of the window (64 m / 512, on the slant), and half a pixel.
    assert edge_error(paint, elevation) < 0.125 / np.sin(np.radians(elevation)) + 0.13


@pytest.mark.parametrize(("file", "right", "wrong"), [
    (FRAME, "dot(relative, -sun_direction)", "dot(relative, sun_direction)"),
    (PASS, "place.x * shadow_right + place.y * shadow_up", "place.x * shadow_right + (1.0 - place.y) * shadow_up"),
    (PASS, "origin = shadow_corner + ", "origin = shadow_corner + 0.02 * shadow_up + "),
])
def test_a_wrong_shadow_is_found(paint: Paint, spoil: Callable, file: str, right: str, wrong: str) -> None:
    with spoil(file, right, wrong):
        # Another sun each time, because the map that other tests drew is still at hand.
        assert edge_error(paint, 30.001 + len(wrong) * 1e-4) > 0.5


def test_a_sun_from_the_other_side_lights_the_foot_of_the_bank(paint: Paint) -> None:
    np.testing.assert_allclose(lit(paint, bank(), worlds.sun(90, 30), 26.0), 1, atol=1e-3)


def test_what_lies_within_the_bias_of_the_first_thing_is_lit(ask: Ask) -> None:
    """Twin: lit where depth <= stored + bias, inside the window; outside it nothing is known to shade."""
    rng = np.random.default_rng(3)
    made = DepthShadowMap(bias=2.0, strength=0.8)
    state = worlds.state(sun=worlds.sun(0, 90))
    position = rng.uniform((-60, -60, 0), (60, 60, 90), (400, 3)).astype(np.float32)
    window = {"shadow_corner": (-50.0, -50.0, 100.0), "shadow_right": (100.0, 0.0, 0.0),
              "shadow_up": (0.0, 100.0, 0.0)}
    found = ask([FRAME], "shadow_visibility(position, 0.0, vec2(0.0))", {"position": position}, state=state,
                techniques={"shadow": made}, textures={"shadow_depth": np.full((4, 4), 60.0)}, values=window)[:, 0]
    inside = (np.abs(position[:, :2]) <= 50).all(axis=1)
    exact = np.where(inside & (100 - position[:, 2] > 62), 0.2, 1.0)
    clear = np.abs(100 - position[:, 2] - 62) > 1e-3
    np.testing.assert_allclose(found[clear], exact[clear], atol=1e-6)
    assert set(np.round(exact, 1)) == {0.2, 1.0}


@pytest.mark.parametrize(("alpha", "threshold", "share"), [
    (75, 0.3, 1.0), (78, 0.3, 0.0), (120, 0.5, 1.0), (130, 0.5, 0.0), (255, 0.3, 0.0),
])
def test_only_opacities_above_the_threshold_cast(ask: Ask, alpha: int, threshold: float, share: float) -> None:
    """The first texel of the depth pass meets the slab's top or the ground."""
    state = worlds.state(sun=worlds.sun(90, 50))
    origin = np.array([40.0, 3.0, 200.0])
    found = ask(
        ["forest/crossing.glsl", PASS], "shadow_depth_texel(pixel).x", {"pixel": np.array([[0.5, 0.5]])},
        pattern=worlds.uniform(alpha), state=state,
        declarations="uniform float shadow_threshold;\nuniform float shadow_resolution;",
        values={"shadow_corner": tuple(origin), "shadow_right": (0.0, 1.0, 0.0), "shadow_up": (0.0, 0.0, 1.0),
                "shadow_threshold": threshold, "shadow_resolution": 1e6})[0, 0]
    # The walk looks first at the last safe step over the canopy, then by half voxels.
    sine = np.sin(np.radians(50))
    exact = 200 / sine if share == 1.0 else 180 / sine
    assert found == pytest.approx(exact, abs=0.35 if share == 1.0 else 0.7)


def test_no_sun_below_the_horizon_and_no_shadow_without_strength(ask: Ask, paint: Paint) -> None:
    made = worlds.state(camera=worlds.map_view(26, 0, 24), sun=worlds.sun(270, -3),
                        **worlds.with_technique("shadow", "depth_shadow_map", resolution=512))
    assert paint(made, bank(), (16, 16), 1).linear[..., :3].max() < 1e-6
    np.testing.assert_allclose(lit(paint, bank(), worlds.sun(270, 30), 26.0, strength=0.0), 1, atol=1e-3)


def test_the_window_holds_what_the_camera_sees() -> None:
    made = worlds.state(camera=worlds.map_view(100, -50, 60), sun=worlds.sun(200, 40))
    found = DepthShadowMap().sun_pass(made, {"terrain": worlds.ground()}, (64, 64))
    assert found is not None
    corner, right, up = (np.array(found.uniforms[f"shadow_{name}"]) for name in ("corner", "right", "up"))
    for x in (75, 125):
        for y in (-75, -25):
            place = [(np.array([x, y, 0.0]) - corner) @ side / (side @ side) for side in (right, up)]
            assert all(0 < share < 1 for share in place)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "shadow", "depth_shadow_map",
        MARCH,
        0.068,  # matter blocks wholly or not at all; 0.75 m of bias; texels without a filter
        against="full",
    )


def test_a_wrong_threshold_costs_more(judge: Judge) -> None:
    late = {"shadow": worlds.technique("shadow", "depth_shadow_map", threshold=0.99)}
    assert judge.distance("shadow", "depth_shadow_map", "full", **late) > 1.1 * (MARCH + 0.068)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", "depth_shadow_map")
