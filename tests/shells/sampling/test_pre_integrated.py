"""Pre-integrated samples: a ramp of extinction and one of colour with few samples, and the sun in thick matter."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.shells.bakes import sky_bake
from renderer.shells.state import ShellsState
from renderer.world.sky import sky_for
from tests.shells.conftest import even
from tests.shells.sampling.test_adaptive import ramp
from tests.shells.shadow.slabs import lit

Draw = Callable[..., np.ndarray]
FILE = "shells/sampling/pre_integrated.glsl"


def drawn(draw: Draw, block: np.ndarray, rate: float = 0.25) -> np.ndarray:
    voxels = {"interpolation": "extinction", "storage": "float"}
    return np.asarray(draw({"sampling": {"kind": "pre_integrated", "rate": rate}, "voxels": voxels}, block)[4, 4])


def test_a_ramp_of_extinction_by_few_samples(draw: Draw) -> None:
    assert drawn(draw, ramp(32))[3] == pytest.approx(1 - np.exp(-1.5 * 0.5), abs=2e-3)


def colours(draw: Draw, rate: float) -> np.ndarray:
    """Even matter whose colour goes from red to blue with height."""
    block, height = even(0.3, layers=32), (np.arange(32) + 0.5) / 32
    block[..., 0], block[..., 2] = height[:, None, None], 1 - height[:, None, None]
    return drawn(draw, block, rate)[:3]


def test_a_ramp_of_colour_by_few_samples(draw: Draw) -> None:
    assert colours(draw, 0.25) == pytest.approx(colours(draw, 8.0), abs=0.015)


def sunlit(draw: Draw, shadow: dict[str, Any]) -> float:
    """Light of a slab of depth 12 whose samples are 1.5 deep, each, where half of the sun comes back to the eye."""

    def sampled(patch: dict[str, Any], *rest: Any, **more: Any) -> np.ndarray:
        return np.asarray(draw({**patch, "sampling": {"kind": "pre_integrated", "rate": 0.5}}, *rest, **more))

    return lit(sampled, shadow, 12.0)


def sun_returned(draw: Draw) -> float:
    """What is seen of the sun in thick matter, of what would be without a shadow; the sky's light is taken off."""
    elevation = np.radians(90.0)
    tables = bake_now(sky_bake(validate(ShellsState, {"scene": "shells"})), Cache())
    sky = 0.5 * float(sky_for(tables, elevation).sky_irradiance[1]) / np.pi
    shadow = {"kind": "deep_shadow_map", "resolution": 128}
    return (sunlit(draw, shadow) - sky) / (sunlit(draw, {"kind": "none"}) - sky)


def test_half_of_the_sun_comes_back_from_thick_matter(draw: Draw) -> None:
    assert sun_returned(draw) == pytest.approx(0.5, abs=0.03)


def test_straight_light_would_be_found(draw: Draw, spoil: Callable) -> None:
    with spoil(FILE, "abs(fall) < 0.02", "abs(fall) < 99.0"):
        assert sun_returned(draw) > 0.55


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("moved * (back - front)", "0.0 * (back - front)"),
        ("0.5 * (first.extinction + last.extinction)", "first.extinction"),
    ],
)
def test_ends_that_do_not_count_are_found(draw: Draw, spoil: Callable, right: str, wrong: str) -> None:
    exact = np.append(colours(draw, 8.0), drawn(draw, ramp(32), 8.0)[3])
    with spoil(FILE, right, wrong):
        assert np.abs(np.append(colours(draw, 0.25), drawn(draw, ramp(32))[3]) - exact).max() > 0.03
