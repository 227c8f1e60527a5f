"""The land beyond the square: it fades into the sky behind it, and nothing fades inside."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.world_scale import CELL, FADE, NODES
from renderer.world.sky import sky_for
from renderer.world.sun import angles
from tests.forest import worlds
from tests.forest.conftest import Ask, Spoil

FILE = "forest/fading.glsl"
HALF = (NODES - 1) / 2 * CELL
SKY = (0.1, 0.2, 0.4)
Paint = Callable[..., Any]


def error(ask: Ask) -> float:
    """Of the share that is seen, against its closed form: in the square, beside it and off its corner."""
    xy = np.concatenate([
        np.random.default_rng(2).uniform(-HALF, HALF, (50, 2)),
        [[HALF + d, y] for d in (1.0, 700.0, 3000.0) for y in (-HALF, 0.0)],
        [[x, -HALF - d] for d in (1.0, 700.0, 3000.0) for x in (0.0, HALF)],
        [[-HALF - 900.0, HALF + 1200.0]],
    ])
    far = np.concatenate([np.zeros(50), np.tile(np.repeat([1.0, 700.0, 3000.0], 2), 2), [1500.0]])
    found = ask([FILE], "land_kept(xy)", {"xy": xy})[:, 0]
    assert (found[:50] == 1).all(), "nothing fades in the square"
    return float(np.abs(found - np.exp(-((far / FADE) ** 2))).max())


def test_the_share_seen_falls_with_the_distance_from_the_square(ask: Ask) -> None:
    assert error(ask) < 1e-5


@pytest.mark.parametrize(("right", "wrong"), [
    ("exp(-dot(out_of, out_of))", "exp(-length(out_of))"),
    ("(terrain_nodes - 1.0)", "(terrain_nodes + 99.0)"),
    ("-dot(out_of, out_of)", "-max(out_of.x, out_of.y) * max(out_of.x, out_of.y)"),
])
def test_another_fading_is_found(ask: Ask, spoil: Spoil, right: str, wrong: str) -> None:
    with spoil(FILE, right, wrong):
        assert error(ask) > 1e-2


@pytest.mark.parametrize("alpha", [0, 40], ids=["meadow", "canopy"])
def test_the_sky_takes_the_place_of_what_fades(paint: Paint, alpha: int) -> None:
    """Closed form: kept x what the same land sends inside the square + (1 - kept) x sky; the opacity is kept."""
    baked = worlds.together(sky=worlds.sky(SKY), terrain=worlds.ground(cover=1.0), pattern=worlds.uniform(alpha))
    given = {"sun": worlds.sun(123, 30), **worlds.PLAIN}
    here = paint(worlds.state(camera=worlds.map_view(0, 0, 8), **given), baked, (16, 16), 16).linear
    outside = {"camera": worlds.map_view(HALF + 1000.0, 0, 8), **given}
    there = paint(worlds.state(**outside), baked, (16, 16), 16).linear
    kept = np.exp(-((1000.0 / FADE) ** 2))
    np.testing.assert_allclose(here[..., 3], 1, atol=1e-6)
    np.testing.assert_allclose(there.mean(axis=(0, 1)), kept * here.mean(axis=(0, 1)), rtol=0.01)
    made = worlds.state(**outside, view={"background": "sky"})
    before = paint(made, baked, (16, 16), 16).linear.mean(axis=(0, 1))
    sky = np.array(SKY) * sky_for(worlds.sky(SKY), angles(made.sun)[1]).view.mean() / np.mean(SKY)
    np.testing.assert_allclose(before[:3], kept * here.mean(axis=(0, 1))[:3] + (1 - kept) * sky, rtol=0.01)
