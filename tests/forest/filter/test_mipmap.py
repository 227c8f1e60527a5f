"""Mip levels: the level by the pixel's width, what a level keeps of the pattern, and its distance to the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.forest.filter.mipmap import Mipmap
from renderer.forest.world_scale import VOXEL
from tests.forest import worlds
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
WIDTHS = np.concatenate([[0.0, 1e-6], VOXEL * np.exp2(np.linspace(-3, 8, 45))])


def levels(ask: Ask, made: Mipmap) -> np.ndarray:
    files = ["forest/filter/mipmap.glsl"]
    return ask(files, "filter_level(width)", {"width": WIDTHS}, techniques={"filter": made})[:, 0]


def error(ask: Ask, bias: float = 0.0) -> float:
    exact = np.clip(np.log2(np.maximum(WIDTHS / VOXEL, 1e-3)) + bias, 0, 5)
    return float(np.abs(levels(ask, Mipmap(bias=bias)) - exact).max())


def test_a_level_doubles_the_voxel(ask: Ask) -> None:
    for bias in (-1.5, 0.0, 2.0):
        assert error(ask, bias) < 1e-4


@pytest.mark.parametrize(("right", "wrong"), [
    ("footprint / voxel_size", "voxel_size / max(footprint, 1e-9)"),
    ("log2(", "log("),
    ("+ filter_bias", "- filter_bias"),
])
def test_a_wrong_level_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/filter/mipmap.glsl", right, wrong):
        assert error(ask, 1.0) > 0.2


def test_levels_only_grow_with_the_pixel(ask: Ask) -> None:
    found = levels(ask, Mipmap(bias=0))
    assert (np.diff(found) >= 0).all()
    assert found.min() == 0
    assert found.max() == 5


def test_a_level_lets_through_as_much_light_as_the_finest(paint: Callable[..., Any]) -> None:
    """Closed form: a uniform slab's opacity composes exactly, so its transmittance is the same at every level."""
    baked = worlds.together(sky=worlds.sky(), terrain=worlds.ground(), pattern=worlds.uniform(12, albedo=1.0))
    seen = []
    for bias in (0.0, 2.0, 3.0):  # levels 0, 1 and 2: pixels are half a voxel wide
        chosen = worlds.with_technique("filter", "mipmap", bias=bias) | {"light": worlds.technique("light", "gouraud")}
        made = worlds.state(camera=worlds.map_view(0, 0, 10), sun=worlds.sun(0, 90), **chosen)
        seen.append(float(paint(made, baked, (32, 32), 16).linear[..., 0].mean()))
    through = (1 - 12 / 255) ** 32
    exact = (through * worlds.GROUND[0] + (1 - through)) / np.pi * worlds.E_SUN[0]
    assert seen == pytest.approx([exact] * 3, rel=0.02)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "filter", "mipmap",
        MARCH,
        0.067,  # pixels of 1.7 m: one mean normal for four voxels and more, foliage spread over them
    )


def test_coarser_levels_cost_more(judge: Judge) -> None:
    coarse = {"filter": worlds.technique("filter", "mipmap", bias=2.0)}
    assert judge.distance("filter", "mipmap", **coarse) > 1.1 * (MARCH + 0.067)


def test_picture(judge: Judge) -> None:
    judge.looks("filter", "mipmap")
