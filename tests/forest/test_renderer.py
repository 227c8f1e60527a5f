"""The forest's renderer: pictures that can be worked out, energy, and textures that never outlive what they show."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer import view
from renderer.forest.pattern import tallest
from renderer.forest.renderer import ForestRenderer, bounds
from renderer.forest.world_scale import CELL, NODES
from renderer.gl.thread import GLThread
from renderer.world.camera import rays
from renderer.world.sampling import offset
from renderer.world.sky import sky_for, sky_radiance
from renderer.world.sun import angles, direction
from tests.forest import truth, worlds
from tests.forest.worlds import PLAIN

Paint = Callable[..., Any]
X = (np.arange(NODES) - (NODES - 1) / 2) * CELL


def level(cover: Any = 0.0, alpha: int = 0, **sky: Any) -> Any:
    return worlds.together(sky=worlds.sky(**sky), terrain=worlds.ground(cover=cover), pattern=worlds.uniform(alpha))


def test_a_meadow_sends_back_its_albedo_of_sun_and_sky(paint: Paint) -> None:
    """Closed form: albedo / pi (E_sun sin(elevation) + E_sky), the same at every pixel."""
    sky = (0.1, 0.2, 0.4)
    made = worlds.state(camera=worlds.map_view(13, -40, 70), sun=worlds.sun(123, 30), **worlds.PLAIN)
    seen = paint(made, level(radiance=sky), (16, 12), 2).linear
    e_sky = sky_for(worlds.sky(sky), angles(made.sun)[1]).sky_irradiance
    exact = np.array(worlds.GROUND) / np.pi * (0.5 * np.array(worlds.E_SUN) + e_sky)
    np.testing.assert_allclose(seen[..., :3], np.broadcast_to(exact, (12, 16, 3)), rtol=1e-4)
    np.testing.assert_array_equal(seen[..., 3], 1)


def test_east_is_right_and_north_is_up_on_a_map(paint: Paint) -> None:
    wood = {"camera": worlds.map_view(0, 0, 80), "sun": worlds.sun(0, 90), **worlds.PLAIN}
    east, north = np.where(X > 0, 1.0, 0.0)[None, :], np.where(X < 0, 1.0, 0.0)[:, None]
    right = paint(worlds.state(**wood), level(east, 255), (16, 16), 4).linear[..., 2]
    up = paint(worlds.state(**wood), level(north, 255), (16, 16), 4).linear[..., 2]
    # Leaves are brighter than the ground in blue.
    assert right[:, 10:].min() > 3 * right[:, :6].max()
    assert up[:6].min() > 3 * up[10:].max()


def test_above_the_land_there_is_the_sky_or_nothing(paint: Paint) -> None:
    baked = truth.grove(worlds.state(**worlds.PLAIN))
    looking = {"camera": {"kind": "look", "eye": [0, 0, 90], "target": [10, 40, 110], "field_of_view": 30}}
    none = worlds.state(**looking, **worlds.PLAIN)
    assert paint(none, baked, (16, 12), 1).linear.max() == 0
    made = worlds.state(**looking, **worlds.PLAIN, view={"background": "sky"})
    seen = paint(made, baked, (16, 12), 1).linear
    directions = rays(made.camera, 16, 12, offset(0))[1]
    now = sky_for(baked["sky"].arrays, angles(made.sun)[1])
    exact = sky_radiance(now, np.asarray(direction(made.sun)), directions)
    np.testing.assert_allclose(seen[..., :3], exact, rtol=2e-3)
    np.testing.assert_array_equal(seen[..., 3], 1)


@pytest.mark.parametrize("kind", ["none", "horizon_map", "double_horizon_map", "depth_shadow_map"])
def test_no_pixel_is_brighter_than_its_matter_can_be(paint: Paint, kind: str) -> None:
    """Energy: radiance <= albedo / pi (E_sun + E_sky), the albedo with the strongest tint, whatever the sun."""
    for sun in ((245, 33), (20, 3)) if kind != "depth_shadow_map" else ((245, 33),):
        shadow = worlds.technique("shadow", kind)
        made = worlds.state(**{**truth.SCENE, **worlds.PLAIN, "shadow": shadow, "sun": worlds.sun(*sun)})
        seen = paint(made, truth.grove(made), (32, 32), 2).linear
        e_sky = sky_for(worlds.sky(truth.SKY), angles(made.sun)[1]).sky_irradiance
        brightest = 0.2 * 1.2 / np.pi * (np.array(worlds.E_SUN) + e_sky)
        assert np.isfinite(seen).all()
        assert (seen[..., :3] >= 0).all()
        assert (seen[..., :3] <= brightest * 1.05).all(), "5 % for albedos in eight bits"
        assert (seen[..., 3] <= 1).all()


def test_a_sun_below_the_horizon_leaves_the_skys_light_alone(paint: Paint) -> None:
    for kind in ("horizon_map", "double_horizon_map", "depth_shadow_map"):
        night = {**truth.SCENE, **worlds.with_technique("shadow", kind), "sun": worlds.sun(245, -4)}
        made = worlds.state(**night)
        dark = truth.grove(made) | worlds.together(sky=worlds.sky())
        assert paint(made, dark, (16, 16), 1).linear[..., :3].max() < 1e-6


CHANGES: list[dict[str, Any]] = [
    {"sun": worlds.sun(235, 36)},
    {"camera": {"azimuth": 230}},
    {"camera": {"field_of_view": 30}},
    {"ground": {"map_seed": 5}},
    {"ground": {"albedo": [0.3, 0.3, 0.3]}},
    {"geometry": {"step": 3.0}},
    {"geometry": worlds.technique("geometry", "slices")},
    {"filter": worlds.technique("filter", "mipmap")},
    {"shadow": {"threshold": 0.9}},
    {"shadow": {"bias": 5.0}},
    {"light": worlds.technique("light", "gouraud")},
]


@pytest.mark.parametrize("change", CHANGES, ids=str)
def test_what_is_kept_never_shows_another_state(
    thread: GLThread, painter: view.Painter, change: dict[str, Any]
) -> None:
    """A renderer that just drew another state draws the same pixels as one that drew nothing before."""
    shaded = {"sun", "shadow", "ground"} & set(change)
    shadow = worlds.technique("shadow", "depth_shadow_map", resolution=512) if shaded else PLAIN["shadow"]
    base = {**truth.SCENE, **PLAIN, "shadow": shadow}
    before, after = worlds.state(**base), worlds.merged(base, change)
    baked = truth.grove(before)
    fresh = view.Painter(thread)
    clean = view.paint(thread, fresh, after, baked, (24, 24), 2).linear
    first = view.paint(thread, painter, before, baked, (24, 24), 2).linear
    second = view.paint(thread, painter, after, baked, (24, 24), 2).linear
    np.testing.assert_array_equal(second, clean)
    assert (second != first).any(), "the change shows"
    np.testing.assert_array_equal(view.paint(thread, painter, before, baked, (24, 24), 2).linear, first)


def test_another_land_is_not_drawn_with_the_last_ones_traces(paint: Paint) -> None:
    made = worlds.state(camera=worlds.map_view(0, 0, 60), sun=worlds.sun(0, 90), **worlds.PLAIN)
    seen = [paint(made, level(cover, alpha), (8, 8), 1).linear[..., 2].mean()
            for cover, alpha in ((0.0, 255), (1.0, 255), (0.0, 255), (1.0, 0))]
    assert seen[0] == seen[2] == pytest.approx(seen[3], rel=1e-5)
    assert seen[1] > 2 * seen[0]


def test_taller_trees_are_not_drawn_with_the_last_ones_bounds(thread: GLThread, paint: Paint) -> None:
    """Rays start where the tallest tree of the pattern may be met."""
    made = worlds.state(camera={"kind": "look", "eye": [0, -60, 30], "target": [0, 0, 12]}, sun=worlds.sun(0, 90),
                        **worlds.with_technique("height_shading", "empirical"))
    low, high = (worlds.together(sky=worlds.sky(), terrain=worlds.ground(), pattern=worlds.uniform(200, layers=layers))
                 for layers in (slice(0, 4), slice(0, 32)))
    paint(made, low, (32, 32), 1)
    clean = view.paint(thread, view.Painter(thread), made, high, (32, 32), 1).linear
    np.testing.assert_array_equal(paint(made, high, (32, 32), 1).linear, clean)


@pytest.mark.parametrize(("kind", "kept"), [("none", False), ("depth_shadow_map", False), ("sun_march", True)])
def test_only_textures_that_last_take_a_place_among_them(kind: str, kept: bool) -> None:
    asked: list[Any] = []
    store = SimpleNamespace(get=lambda key, make: asked.append(key) or {})
    state = worlds.state(shadow={"kind": kind})
    ForestRenderer._kept(SimpleNamespace(_baked=store, _gl=None), "shadow", state.shadow, state, {})  # type: ignore[arg-type]
    assert bool(asked) is kept


def test_bounds_are_those_of_a_plane_and_a_kink() -> None:
    plane = (0.3 * X[None, :] + 0.4 * X[:, None]).astype(np.float32)
    found = bounds(plane - plane.min(), 15.0)
    assert found["terrain_steepness"] == pytest.approx(0.5, rel=1e-3)
    assert found["terrain_bend"] == pytest.approx(0, abs=1e-3)
    assert found["scene_top"] == pytest.approx(plane.max() - plane.min() + 15, rel=1e-5)
    kinked = np.repeat(np.maximum(X, 0)[None, :], NODES, axis=0).astype(np.float32)
    assert bounds(kinked, 0)["terrain_bend"] >= 0.5 / CELL, "the slope turns by 1 within two cells"
    twisted = np.outer(X, X).astype(np.float32) / 1000
    along = np.array([1, -1]) / np.sqrt(2)
    # z = x y / 1000 along a diagonal: z'' = 2 along_x along_y / 1000
    assert bounds(twisted, 0)["terrain_bend"] >= abs(2 * along[0] * along[1] / 1000)


def test_no_voxel_stands_over_the_tallest() -> None:
    for layers, top in ((slice(None), 20.0), (slice(0, 16), 10.0), (slice(4, 5), 3.125)):
        found = tallest(worlds.uniform(50, layers=layers)["colour"])
        # Rays read voxels up to half a voxel off.
        assert top <= found <= top + 0.7
