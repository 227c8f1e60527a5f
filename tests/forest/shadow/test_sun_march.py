"""Sun march: Beer and Lambert's law in an even canopy, the land's shadow, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.land_shadow import HIGHEST, LOWEST, bake_stand_tops, shadow_bounds, shadow_height
from renderer.forest.shadow.sun_march import SunMarch
from renderer.forest.world_scale import VOXEL
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
FILE = "forest/shadow/sun_march.glsl"
ALPHA = 6
"""Opacity of the even canopy: thin enough that all heights see some of the sun."""
RAYS = 3000


def seen(
    ask: Ask, made: SunMarch, sun: dict[str, Any], position: np.ndarray, *, alpha: int = ALPHA, terrain: Any = None
) -> np.ndarray:
    """Share of the sun at places (N, 3) of an even canopy."""
    state = worlds.state(sun=sun)
    ground = terrain or worlds.ground()
    azimuth, elevation = np.radians(sun["azimuth"]), np.radians(sun["elevation"])
    height = position[:, 2] / 20
    pattern = worlds.uniform(alpha)
    tops = bake_stand_tops({}, {"terrain": ground, "pattern": pattern}, lambda share, words: None)["tops"]
    return ask(
        [FILE],
        "shadow_visibility(position, h, vec2(0.0))",
        {"position": position, "h": height},
        state=state,
        terrain=ground,
        pattern=pattern,
        techniques={"shadow": made},
        values={"sample_shift": 0.0},
        textures={"shadow_land": shadow_bounds(ground, tops, (azimuth, elevation))},
    )[:, 0]


def allowed(step: float, growth: float, depth: float) -> float:
    """How far the mean of `RAYS` may lie from exp(-depth), for steps that begin at `step` voxels.

    Steps before the last one are met whole. That one, of depth d behind the transmittance T, is met or missed whole: by
    convexity T d^2 / 8 at most, and three deviations of a share of rays. Voxels of coarser levels are rounded to bytes.
    """
    whole = worlds.uniform(ALPHA)
    held = [whole[f"colour{end}"].max() / 255 for end in ("", *(f"_{n}" for n in range(1, 6)))]
    rounded = [abs(np.log1p(-h) / (2**n * np.log1p(-ALPHA / 255)) - 1) for n, h in enumerate(held)]
    voxel = -np.log1p(-ALPHA / 255)
    start, ds = 0.0, step
    while (start + ds) * voxel < depth:
        start, ds = start + ds, ds * (1 + growth)
    d, before = ds * voxel, np.exp(-start * voxel)
    level = max(int(np.log2(ds)), 0)
    off = np.exp(-depth) * depth * max(rounded[:level + 1])
    return float(before * (d**2 / 8 + 1.5 * d / np.sqrt(RAYS)) + off)


def beer_error(ask: Ask, step: float, growth: float) -> float:
    """Worst error, over heights and suns, of the mean visibility against (1 - alpha)^(path / voxel), as a share of
    what is allowed there."""
    rng = np.random.default_rng(2)
    worst = 0.0
    for elevation in (25.0, 50.0, 85.0):
        for above in (0.5, 6.0, 13.0, 19.5):
            places = np.column_stack([rng.uniform(-300, 300, (RAYS, 2)), np.full(RAYS, above)])
            found = seen(ask, SunMarch(step=step, growth=growth), worlds.sun(70, elevation), places)
            depth = -np.log1p(-ALPHA / 255) * (20 - above) / np.sin(np.radians(elevation)) / VOXEL
            worst = max(worst, abs(float(found.mean()) - np.exp(-depth)) / allowed(step, growth, depth))
    return worst


@pytest.mark.parametrize(("step", "growth"), [(1.0, 0.0), (2.0, 0.4), (1.5, 0.4)])
def test_an_even_canopy_dims_as_beer_and_lambert_say(ask: Ask, step: float, growth: float) -> None:
    assert beer_error(ask, step, growth) < 1


@pytest.mark.parametrize(("right", "wrong"), [
    ("* width / scale", "* width * 2.0"),
    ("start += max(ds,", "start += max(1.5 * ds,"),
    ("tau += above < 0.0 ? 100.0 : met ?", "tau += above < 0.0 ? 100.0 : !met ?"),
    ("bool met = rise < 1.0 &&", "bool met = rise < 0.9 &&"),
])
def test_a_wrong_depth_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert beer_error(ask, step=1.0, growth=0.0) > 3


def test_light_grows_with_height_and_none_comes_from_below(ask: Ask) -> None:
    places = np.column_stack([np.zeros((64, 2)), np.linspace(0.1, 19.9, 64)])
    for elevation in (10.0, 40.0):
        found = seen(ask, SunMarch(step=0.5, growth=0.0), worlds.sun(200, elevation), places)
        assert ((found >= 0) & (found <= 1)).all()
        assert (np.diff(found) > -0.02).all()
    assert (seen(ask, SunMarch(), worlds.sun(200, -2), places) == 0).all()


def test_a_glade_is_bright_and_opaque_matter_dark(ask: Ask) -> None:
    places = np.column_stack([np.zeros((16, 2)), np.linspace(0.5, 15, 16)])
    bare = seen(ask, SunMarch(), worlds.sun(120, 30), places, alpha=255, terrain=worlds.ground(cover=0.0))
    np.testing.assert_allclose(bare, 1, atol=1e-5)
    assert seen(ask, SunMarch(), worlds.sun(120, 30), places, alpha=255).max() < 0.02


def bank() -> dict[str, np.ndarray]:
    """A plateau 40 m high west of x = -52, level ground east of x = -44."""
    x = (np.arange(512) - 255.5) * 8
    return worlds.ground(np.where(x < -48, 40.0, 0.0)[None, :], 0.0)


def brink_error(ask: Ask, elevation: float = 20.0) -> float:
    """How far from its true place [m] the plateau's shadow ends on the ground."""
    x = np.linspace(-40, 160, 4000)
    places = np.column_stack([x, np.zeros_like(x), np.full_like(x, 0.3)])
    found = seen(ask, SunMarch(), worlds.sun(270, elevation), places, alpha=0, terrain=bank())
    exact = -52 + (40 - 0.3) / np.tan(np.radians(elevation))
    return abs(float(x[found < 0.5].max(initial=-40)) - exact)


def test_a_plateaus_shadow_ends_where_geometry_says(ask: Ask) -> None:
    # The last steps of the ray are some metres long where it passes the brink.
    assert max(brink_error(ask, 20.0), brink_error(ask, 31.0)) < 1.0


def test_a_shadow_of_the_wrong_height_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil(FILE, "p.z > bounds.y + BOUND_MARGIN", "p.z > bounds.y - 5.0"):
        assert brink_error(ask) > 5


def through_a_far_stand(ask: Ask) -> float:
    """Worst error of what an even stand on the plateau lets through to places far below, over how deep rays meet it."""
    land = bank() | {"presence": worlds.ground(0.0, (np.arange(512) < 249)[None, :])["presence"]}
    elevation, depth = 30.0, np.array([4.0, 8.0, 12.0, 16.0])
    # Rays that come over the plateau's edge so deep under the stand's top.
    edge = (249 - 255.5) * 8 - 4.0
    x = edge + (40 + 20 - depth - 0.3) / np.tan(np.radians(elevation))
    y = np.linspace(-400, 400, 500)
    places = np.column_stack([np.repeat(x, len(y)), np.tile(y, len(x)), np.full(len(x) * len(y), 0.3)])
    found = seen(ask, SunMarch(), worlds.sun(270, elevation), places, terrain=land).reshape(len(x), -1).mean(axis=1)
    exact = (1 - ALPHA / 255) ** (depth / np.sin(np.radians(elevation)) / VOXEL)
    return float(np.abs(found - exact).max())


def test_a_stand_far_off_dims_as_beer_and_lambert_say(ask: Ask) -> None:
    # The stand begins between two places of the map of trees, a tenth of its way through.
    assert through_a_far_stand(ask) < 0.04


def test_light_through_opaque_ridges_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil(FILE, "const int VISITS = 64", "const int VISITS = 1"):
        assert through_a_far_stand(ask) > 0.3


def past_a_skimmed_slope(ask: Ask) -> float:
    """Error of what a stand lets through behind a slope with sixteen folds, each of which a low sun's rays touch."""
    nodes, x0, z0, rise = (np.arange(512) - 255.5) * 8, 1200.0, 200.0, np.tan(np.radians(6.0))
    walked = np.floor((x0 - nodes) / 8).astype(int)
    # Over the ray: the folds' tops, then those of a stand that it crosses 8 m deep, and low ground before and behind.
    folds = np.array([0.02, -4.0, -6.0, -6.0, -6.0, -4.0])[walked % 6]
    tops = np.where((walked > 2) & (walked <= 98), folds, np.where((walked > 100) & (walked <= 104), 8.0, -40.0))
    z = z0 + (x0 - nodes) * rise - 20.0 + tops
    y = np.linspace(-400, 400, 1000)
    places = np.column_stack([np.full_like(y, x0), y, np.full_like(y, z0)])
    found = seen(ask, SunMarch(), worlds.sun(270, 6.0), places, terrain=worlds.ground(z[None, :]))
    along = np.linspace(0, 1000, 100_000)
    above = z0 + along * rise - np.interp(x0 - along, nodes, z)
    within = np.mean((above > 0) & (above < 20)) * 1000 / np.cos(np.radians(6.0))
    return abs(float(found.mean()) - (1 - ALPHA / 255) ** (within / VOXEL))


def test_a_skimmed_slope_does_not_end_the_way_to_the_sun(ask: Ask) -> None:
    assert past_a_skimmed_slope(ask) < 0.02  # a step's share of the stand, for each of a thousand rays


def test_a_way_that_ends_too_early_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil(FILE, "const int VISITS = 64", "const int VISITS = 8"):
        assert past_a_skimmed_slope(ask) > 0.5


@pytest.mark.parametrize("azimuth", [0.0, 90.0, 180.0, 270.0, 37.0, 214.0])
def test_the_land_s_shadow_is_the_highest_ray(azimuth: float) -> None:
    """Against a search along each node's own ray, over a smooth land that both interpolate and continue alike."""
    place = np.arange(48) * 10.0
    x, y = np.meshgrid(place, -place)
    land = 30 * np.sin(x / 90) * np.cos(y / 70) + 20 * np.sin((x + y) / 160)
    tangent, a = np.tan(np.radians(14.0)), np.radians(azimuth)
    grid = land
    found = shadow_height(grid, 10.0, a, np.radians(14.0))
    distance = np.arange(10.0, 480.0, 2.5)
    column = x[..., None] / 10 + distance * np.sin(a) / 10
    row = -y[..., None] / 10 - distance * np.cos(a) / 10
    c, r = np.clip(column, 0, 46.999), np.clip(row, 0, 46.999)
    j, i = c.astype(int), r.astype(int)
    u, v = c - j, r - i
    z = (land[i, j] * (1 - u) + land[i, j + 1] * u) * (1 - v) + (land[i + 1, j] * (1 - u) + land[i + 1, j + 1] * u) * v
    exact = (z - distance * tangent).max(axis=-1)
    hidden = exact > land + 1.0
    assert hidden.any()
    # A node between two lines takes their mean: an error where a ridge ends, and little elsewhere.
    assert np.abs(found - exact)[hidden].max() < 1.0
    assert np.abs(found - exact)[hidden].mean() < 0.12
    assert (found <= np.maximum(exact, land - 30) + 1.0).all()
    sure, free = (shadow_height(grid, 10.0, a, np.radians(14.0), choice) for choice in (LOWEST, HIGHEST))
    # What the march relies on, but for its margins.
    assert (sure <= exact + 2.0)[hidden].all()
    assert (free >= exact - 0.5)[hidden].all()


def test_at_night_everything_lies_in_shadow() -> None:
    assert shadow_height(np.zeros((4, 4)), 8.0, 1.0, -0.1).min() > 1e5


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "shadow",
        "sun_march",
        MARCH,
        0.012,  # one random place for each step of a voxel and a half
        against="full",
    )


def test_longer_steps_cost_more(judge: Judge) -> None:
    coarse = {"shadow": worlds.technique("shadow", "sun_march", step=8.0, growth=1.0, bias=1.0)}
    assert judge.distance("shadow", "sun_march", "full", **coarse) > 1.1 * (MARCH + 0.012)


def test_picture(judge: Judge) -> None:
    judge.looks("shadow", "sun_march")
