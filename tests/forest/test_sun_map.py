"""What a map drawn from the sun keeps, and how a point is compared with it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.forest import worlds
from tests.forest.shadow.banks import WALK, first_in_slab

Ask = Callable[..., np.ndarray]
MAP = "forest/sun_map.glsl"
AXES = "uniform vec3 shadow_right, shadow_up;"


@pytest.mark.parametrize("elevation", [90.0, 50.0, 20.0])
@pytest.mark.parametrize(("alpha", "threshold"), [(20, 0.3), (60, 0.3), (60, 0.9), (200, 0.5)])
def test_light_is_lost_where_gathered_opacity_passes_the_threshold(
    ask: Ask, alpha: int, threshold: float, elevation: float
) -> None:
    """Closed form: 1 - exp(-sigma s) = threshold, sigma = -ln(1 - alpha) / 0.625 m."""
    exact = np.log(1 - threshold) / np.log(1 - alpha / 255) * worlds.VOXEL
    # Half a step of one voxel, and the slack of the entry.
    assert first_in_slab(ask, alpha, threshold, elevation) == pytest.approx(exact, abs=0.5)


def test_the_slab_lets_the_light_through_to_the_ground(ask: Ask) -> None:
    assert first_in_slab(ask, 1, 0.3, 90.0) == pytest.approx(20.0, abs=0.02)


def test_coarse_texels_gather_the_same(ask: Ask) -> None:
    """Opacity composes from level to level, so the place may shift by half a step of the level only."""
    fine, coarse = (first_in_slab(ask, 20, 0.5, 60.0, texel) for texel in (0.5, 2.5))
    assert coarse == pytest.approx(fine, abs=1.3)


def test_a_walk_that_forgets_what_it_gathered_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil(WALK, "gathered += depth;", "gathered = 0.0;"):
        assert first_in_slab(ask, 20, 0.5, 90.0) > 10


def test_light_fades_behind_the_first_matter(ask: Ask) -> None:
    behind = np.array([-3.0, 0.5, 0.99, 1.01, 2.0, 5.0])
    inputs = {"sunward": 10 - behind, "fade": np.zeros(6)}
    found = ask([MAP], "past_first(10.0, sunward, 1.0, fade)", inputs, declarations=AXES)[:, 0]
    np.testing.assert_array_equal(found, [1, 1, 1, 0, 0, 0])
    soft = ask([MAP], "past_first(10.0, sunward, 1.0, fade)", {**inputs, "fade": np.full(6, 2.0)}, declarations=AXES)
    np.testing.assert_allclose(soft[:, 0], np.exp(-np.maximum(behind - 1, 0) / 2), atol=1e-6)


def test_a_slope_is_parallel_to_itself(ask: Ask) -> None:
    """Along the plane of the ground the sunward coordinate changes as `sunward_slope` says."""
    state = worlds.state(sun=worlds.sun(90, 40))
    x = (np.arange(512) - 255.5) * 8
    tilted = worlds.ground(np.broadcast_to(0.3 * (x + 2044)[None, :], (512, 512)), 0.0)
    sun = np.array([np.cos(np.radians(40)), 0.0, np.sin(np.radians(40))])
    up = np.cross(sun, (0.0, 1.0, 0.0))
    found = ask(
        [MAP],
        "sunward_slope(xy)",
        {"xy": np.array([[16.0, -30.0]])},
        2,
        terrain=tilted,
        state=state,
        declarations=AXES,
        values={"shadow_right": (0.0, 1.0, 0.0), "shadow_up": tuple(up)},
    )[0]
    for step in ([8.0, 0.0, 2.4], [0.0, 8.0, 0.0], [8.0, -8.0, 2.4]):
        across = np.array([np.dot(step, (0.0, 1.0, 0.0)), np.dot(step, up)])
        assert across @ found == pytest.approx(np.dot(step, sun), abs=0.02)
