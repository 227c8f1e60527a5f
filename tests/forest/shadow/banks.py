"""A bank whose shadow geometry tells, for every map drawn from the sun; and what such a map keeps of a slab."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.forest.sun_map import SunView
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Paint = Callable[..., Any]
Ask = Callable[..., np.ndarray]
HEIGHT = 24.0
WALK = "forest/sun_walk.glsl"

AXES = {"shadow_right": (0.0, 1.0, 0.0), "shadow_up": (0.0, 0.0, 1.0), "shadow_away": 1e5}
"""Axes that any sun in the east leaves unmoved across its light, where only their plane matters."""


def lit(paint: Paint, baked: Any, sun: dict[str, Any], x: float, kind: str, **shadow: Any) -> np.ndarray:
    """Share of the sun on 96 places, 0.25 m apart, around x, of level bare ground seen from above."""
    chosen = worlds.with_technique("shadow", kind, **{"resolution": 512, **shadow})
    made = worlds.state(camera=worlds.map_view(x, 0.0, 24.0), sun=sun, **chosen)
    light = paint(made, baked, (96, 96), 1).linear[48, :, 0]
    return np.asarray(light / (worlds.GROUND[0] / np.pi * worlds.E_SUN[0] * np.sin(np.radians(sun["elevation"]))))


def bank() -> Any:
    """A plateau in the west that ends at x = -20 and falls at 45 degrees to level ground at x = 4."""
    x = (np.arange(512) - 255.5) * 8
    return worlds.together(
        sky=worlds.sky(), terrain=worlds.ground(np.clip(4 - x, 0, HEIGHT)[None, :], 0.0), pattern=worlds.uniform(0)
    )


def edge_error(paint: Paint, kind: str, elevation: float = 30.0, **shadow: Any) -> float:
    """How far the shadow's end lies from the brink's x + height / tan(elevation) [m]."""
    exact = -20 + HEIGHT / np.tan(np.radians(elevation))
    shares = lit(paint, bank(), worlds.sun(270, elevation), exact, kind, **shadow)
    x = exact + (np.arange(96) + 0.5 - 48) * 0.25
    dark = x[shares < 0.5]
    return abs(float(dark.max() if len(dark) else x[0]) + 0.125 - exact)


def far_side_is_lit(paint: Paint, kind: str) -> None:
    """Assert that a sun from the other side lights the foot of the bank."""
    np.testing.assert_allclose(lit(paint, bank(), worlds.sun(90, 30), 26.0, kind), 1, atol=1e-3)


def holds_cost(judge: Judge, kind: str, cost: float, fixed: dict[str, Any]) -> None:
    """Assert that a depth map is as near to the reference as it was measured, and with a late threshold not."""
    judge.holds("shadow", kind, MARCH, cost, against="full", shadow=worlds.technique("shadow", kind, **fixed))
    late = {"shadow": worlds.technique("shadow", kind, **{**fixed, "threshold": 0.99})}
    assert judge.distance("shadow", kind, "full", **late) > 1.1 * (MARCH + cost)


def stands_still_when_snapped(technique: Callable[..., SunView]) -> None:
    """Assert that only a snapped map keeps its texels while the camera moves."""

    def corner(x: float, snapping: bool) -> np.ndarray:
        made = worlds.state(camera=worlds.map_view(x, -50, 60), sun=worlds.sun(200, 40))
        found = technique(snapping=snapping).sun_pass(made, {"terrain": worlds.ground()}, (64, 64))
        assert found is not None
        low, side = np.split(np.array(found.uniforms["shadow_window"]), 2)
        return np.asarray(low / side % 1)

    assert np.abs(corner(100.0, True) - corner(100.37, True)).max() < 1e-6
    assert np.abs(corner(100.0, False) - corner(100.37, False)).max() > 0.01


def first_in_slab(ask: Ask, alpha: int, threshold: float, elevation: float, texel: float = 0.5) -> float:
    """How far [m] the light has come into a slab of one opacity, 20 m thick, where a map says that it is hidden."""
    state = worlds.state(sun=worlds.sun(90, elevation))
    sun = np.array([np.cos(np.radians(elevation)), 0.0, np.sin(np.radians(elevation))])
    up = np.cross(sun, (0.0, 1.0, 0.0))
    found = ask(
        [WALK],
        f"first_sunward(line, {texel}, {threshold})",
        {"line": np.array([[3.0, 40.0]])},
        pattern=worlds.uniform(alpha),
        state=state,
        declarations="uniform vec3 shadow_right, shadow_up;\nuniform float shadow_away;",
        values={"shadow_right": (0.0, 1.0, 0.0), "shadow_up": tuple(up), "shadow_away": 1e5},
    )[0, 0]
    place = 3.0 * np.array([0.0, 1.0, 0.0]) + 40.0 * up + found * sun
    return float((20.0 - place[2]) / sun[2])
