"""Ray marching: transmittance of slabs, what skipping and stopping may change, distance to the reference."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.geometry.ray_march import RayMarch
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, NODES, VOXEL
from tests.forest import worlds
from tests.forest.slabs import ALPHA, FILES, NOISE, slab_error, strata, trace
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
DOWN = [(0, 0, -1), (0.6, 0, -0.8), (-0.5, 0.7, -0.5)]


def budget(step: float) -> float:
    """Noise, and the curvature of the exponential over one step: the last one is met or missed whole."""
    return NOISE + (1 - (1 - ALPHA / 255) ** step) ** 2 / 4


@pytest.mark.parametrize("direction", DOWN)
@pytest.mark.parametrize("step", [0.25, 1.0, 2.0, 4.0])
def test_a_slab_lets_through_what_its_length_says(ask: Ask, direction: tuple[float, ...], step: float) -> None:
    assert slab_error(ask, RayMarch(first=1, step=step, stop=0), direction) < budget(step)


def test_a_slab_on_a_slope_too(ask: Ask) -> None:
    for slope in (0.5, -0.5):
        assert slab_error(ask, RayMarch(first=1, step=1, stop=0), (0.5, 0.3, -0.8), slope) < budget(1)


@pytest.mark.parametrize(("right", "wrong"), [
    ("* ds / voxel_size", ""),
    ("ds / voxel_size", "ds"),
    ("depth + tau", "max(depth, tau)"),
])
def test_a_wrong_transmittance_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/geometry/ray_march.glsl", right, wrong):
        assert slab_error(ask, RayMarch(first=1, step=2, stop=0), DOWN[1]) > budget(2)


def test_each_ray_meets_as_many_samples_as_its_twin_counts(ask: Ask) -> None:
    """Rising rays from inside the slab leave it through the top: opacity is 1 - (1 - alpha)^(samples met)."""
    jitter = strata()[1].astype(np.float64)
    rise = 0.6
    found = trace(ask, RayMarch(first=1, step=1, stop=0), (0, 0, 7.0), (0.8, 0, rise), worlds.uniform(ALPHA))
    first = 7.0 + jitter * VOXEL * rise
    samples = np.floor((20.0 - first) / (VOXEL * rise)) + 1
    clear = np.abs((20.0 - first) / (VOXEL * rise) % 1 - 0.5) < 0.49  # beside the top float32 may say either
    np.testing.assert_allclose(found[clear, 1], 1 - (1 - ALPHA / 255) ** samples[clear], atol=2e-4)
    assert (found[:, 0] == 0).all(), "they never see the ground"


def layered(safe: int) -> dict[str, np.ndarray]:
    """Matter in layers 12 to 15 alone, with true safe distances raised by `safe`."""
    made = worlds.uniform(ALPHA * 4, layers=slice(12, 16))
    away = np.maximum(np.maximum(12 - np.arange(32), np.arange(32) - 15), 0)
    made["anchor"][..., 2] = (away + safe * (away > 0))[:, None, None]
    return made


def skipping_error(ask: Ask, safe: int) -> float:
    found = trace(ask, RayMarch(first=1, stop=0, step=0.5), (0, 0, 20.0), (0.3, 0.2, -0.9), layered(safe))
    length = np.linalg.norm((0.3, 0.2, 0.9)) / 0.9
    return abs(float(found[:, 0].mean()) - (1 - ALPHA * 4 / 255) ** (4 * length))


def test_skipping_what_is_empty_changes_nothing(ask: Ask) -> None:
    # Skips end beside the slab at places that depend on the ray: up to half a step (of 4.3) is met more or less.
    assert skipping_error(ask, 0) < 0.03


def test_a_skip_too_long_is_found(ask: Ask) -> None:
    assert skipping_error(ask, 4) > 0.03


def depths_met(ask: Ask, level: int, step: float, pattern: dict[str, np.ndarray]) -> np.ndarray:
    """How deep [m] below the top of a canopy rays straight down look at the light, at one mip level; NaN where they do
    not before the ground."""
    xi, jitter = strata()
    body = f"""Event event = no_event(xi);
    geometry_trace(vec3(0.0, 0.0, {CANOPY_HEIGHT:.1f}), vec3(0.0, 0.0, -1.0), 0.0, vec4(jitter, xi, 0.5, 0.5), event);
    result = event.place.zw;"""
    found = ask([*FILES[:2], "forest/geometry/ray_march.glsl"], body, {"xi": xi, "jitter": jitter}, 2,
                pattern=pattern, techniques={"geometry": RayMarch(first=1, step=step, stop=0)},
                declarations=f"float filter_level(float footprint) {{ return {level}.0; }}").astype(np.float64)
    return np.where(found[:, 1] >= 0, CANOPY_HEIGHT - found[:, 0], np.nan)


def depth_error(ask: Ask, level: int, step: float) -> float:
    """Of the worst ray [m], and infinite where others reach the ground: in an even canopy light is looked at where the
    depth of matter passes the ray's level, however long the steps."""
    pattern = worlds.uniform(4 * ALPHA)
    for number in range(1, 6):
        pattern[f"seen_{number}"][..., 3] = 4 * ALPHA
    exact = VOXEL * np.log1p(-strata()[0].astype(float)) / np.log1p(-4 * ALPHA / 255)
    found = depths_met(ask, level, step, pattern)
    clear = np.abs(exact - CANOPY_HEIGHT) > step * VOXEL * min(2**level, 6)  # the last step is met or missed whole
    if (np.isnan(found) != (exact > CANOPY_HEIGHT))[clear].any():
        return math.inf
    return float(np.nanmax(np.abs(found - exact)[clear]))


@pytest.mark.parametrize(("level", "step"), [(1, 0.25), (1, 4.0), (3, 1.0), (5, 2.0)])
def test_light_is_looked_at_where_its_depth_is_passed(ask: Ask, level: int, step: float) -> None:
    # float32 of a height, and of a logarithm near the end of its range.
    assert depth_error(ask, level, step) < 0.02


def test_at_the_finest_level_it_is_half_the_way_there(ask: Ask) -> None:
    assert 0.4 * 2 * VOXEL < depth_error(ask, 0, 2.0) < 0.6 * 2 * VOXEL


@pytest.mark.parametrize(("right", "wrong"), [
    ("(wanted - depth) / max(tau, 1e-6)", "0.5"),
    ("BEYOND) - jitter.x)", "BEYOND))"),
])
def test_a_wrong_depth_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/geometry/ray_march.glsl", right, wrong):
        assert depth_error(ask, 3, 1.0) > 0.5


def thin_error(ask: Ask, level: int) -> float:
    """Of the share of rays that pass a sheet of five metres, thick enough to stop nine in ten."""
    pattern = worlds.with_levels(worlds.uniform(64, layers=slice(12, 20)))
    passed = np.isnan(depths_met(ask, level, 1.0, pattern)).mean()
    return abs(float(passed) - (1 - 64 / 255) ** 8)


@pytest.mark.parametrize("level", [0, 3, 5])
def test_coarse_steps_do_not_step_over_a_canopy(ask: Ask, level: int) -> None:
    # Steps of six layers meet eight layers once or twice: that costs 0.03. Coarse levels are true to slanted rays, and
    # straight down a quarter too thin, 0.05.
    assert thin_error(ask, level) < 0.1


def test_steps_as_long_as_their_voxels_are_found(ask: Ask, spoil: Callable) -> None:
    with spoil("forest/geometry/ray_march.glsl", "min(scale, max(STEP_LAYERS / max(abs(climb), 1e-3), 1.0))",
               "scale"):
        assert thin_error(ask, 0) < 0.04, "they are the same where voxels are small"
        assert thin_error(ask, 5) > 0.3


def bare_hills_missed(ask: Ask) -> float:
    """Share of rays over bare waves of ground that do not end on the first wave in their way.

    Twin: the first of steps of 5 cm that lies below the ground, which is linear between nodes.
    """
    x = (np.arange(NODES) - (NODES - 1) / 2) * CELL
    z = 20 * (1 + np.sin(x / 18))
    origin = np.stack([np.linspace(-300, 300, 60), np.full(60, 3.0), np.full(60, 48.0)], axis=1)
    slope = np.radians(np.linspace(2, 14, 60))
    direction = np.stack([np.cos(slope), 0 * slope, -np.sin(slope)], axis=1)
    t = np.arange(0, 1500, 0.05)
    exact = np.array([t[(o[2] + t * d[2] <= np.interp(o[0] + t * d[0], x, z)).argmax()]
                      for o, d in zip(origin, direction, strict=True)])
    body = """Event event = no_event(0.5);
    geometry_trace(origin, direction, 0.0, vec4(0.5), event);
    result = event.place.w == GROUND ? dot(event.place.xyz - origin, direction) : -1.0;"""
    found = ask([*FILES, "forest/geometry/ray_march.glsl"], body, {"origin": origin, "direction": direction},
                terrain=worlds.ground(z[None, :], 0.0), techniques={"geometry": RayMarch(first=1, step=1)})[:, 0]
    return float((np.abs(found - exact) > 1.5).mean())


def test_no_skip_passes_through_bare_hills(ask: Ask) -> None:
    # A ray that cuts a crest by less than a step may miss it.
    assert bare_hills_missed(ask) <= 0.05


def test_a_skip_through_a_hill_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil("forest/geometry/ray_march.glsl", "min(skip, safe)", "skip"):
        assert bare_hills_missed(ask) > 0.2


def test_early_stop_closes_a_ray_and_nothing_else(ask: Ask) -> None:
    found = trace(ask, RayMarch(first=1, step=1, stop=0.2), (0, 0, 20.0), (0.8, 0, -0.6), worlds.uniform(ALPHA))
    assert (found[:, 0] == 0).all(), "the ground is seen through 8 % only"
    assert (found[:, 1] == 1).all()
    seen = trace(ask, RayMarch(first=1, step=1, stop=0.05), (0, 0, 20.0), (0.8, 0, -0.6), worlds.uniform(ALPHA))
    assert seen[:, 0].mean() == pytest.approx((1 - ALPHA / 255) ** (32 / 0.6), abs=budget(1))


def test_light_falls_on_the_first_matter_of_an_opaque_canopy(ask: Ask) -> None:
    found = trace(ask, RayMarch(first=1, step=0.25), (0, 0, 20.0), (0, 0, -1), worlds.uniform(255))
    assert (found[:, 3] > 20 - 2 * VOXEL).all()
    assert (found[:, 2] <= 1).all()


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds("geometry", "ray_march", MARCH)


def test_marching_with_longer_steps_costs_more(judge: Judge) -> None:
    longer = {"geometry": worlds.technique("geometry", "ray_march", step=4.0)}
    assert judge.distance("geometry", "ray_march", **longer) > 1.1 * MARCH


def test_picture(judge: Judge) -> None:
    judge.looks("geometry", "ray_march")
