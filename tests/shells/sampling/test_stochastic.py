"""Chance in place of interpolation and of many lights: right in the mean, whole steps or long ones."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.shells.conftest import even, sigma
from tests.shells.sampling.test_adaptive import ramp
from tests.shells.test_against_reference import GLOBE, apart, blobs, reference, tilted

Draw = Callable[..., np.ndarray]
FILE = "shells/sampling/stochastic.glsl"
SAMPLES = 64
STOCHASTIC = {"kind": "stochastic", "rate": 1.0, "most": 256}
STRAIGHT = {"interpolation": "straight", "storage": "float"}
LIT: dict[str, Any] = {
    **GLOBE, "sampling": {**STOCHASTIC, "rate": 2.0}, "voxels": STRAIGHT, "light": {"kind": "lambert"},
    "sun": {"kind": "direction", "azimuth": 60, "elevation": 35},
}  # fmt: skip


def seen(draw: Draw, block: np.ndarray, samples: int = 1, **sampling: float) -> np.ndarray:
    patch = {"sampling": {**STOCHASTIC, **sampling}, "voxels": STRAIGHT}
    return draw(patch, block, samples=samples)[2:6, 2:6].mean(axis=(0, 1))


@pytest.mark.parametrize("alpha", [0.004, 0.2, 0.9])
def test_even_matter_hides_by_its_length(draw: Draw, alpha: float) -> None:
    found = seen(draw, even(alpha, (0.2, 0.4, 0.8)))
    opacity = 1 - np.exp(-sigma(alpha) * 0.5)
    assert found[3] == pytest.approx(opacity, rel=0.02, abs=1e-3)
    np.testing.assert_allclose(found[:3], found[3] * np.array([0.2, 0.4, 0.8]), rtol=1e-3)


def test_empty_matter_is_nothing(draw: Draw) -> None:
    assert not seen(draw, even(0.0)).any()


def test_the_mean_over_chance_is_what_is_interpolated(draw: Draw, spoil: Callable) -> None:
    """A ramp's colour changes with its height, so that the places that are lit count, too."""
    block = ramp(8)
    block[..., 0] = np.linspace(1, 0, 8)[:, None, None]
    right = draw({"sampling": {"kind": "adaptive", "rate": 16.0, "lit": 0.0, "jitter": 0.0, "most": 256},
                  "voxels": STRAIGHT}, block)[4, 4]  # fmt: skip
    assert np.abs(seen(draw, block, SAMPLES) - right).max() < 0.006
    with spoil(FILE, "level_of < weight", "level_of < 3.0 * weight"):
        assert np.abs(seen(draw, block, SAMPLES) - right).max() > 0.012
    with spoil(FILE, "sampling_jitter * (turned - 0.5)", "sampling_jitter * (turned + 0.5)"):
        assert np.abs(seen(draw, block, SAMPLES) - right).max() > 0.012


def test_one_place_is_as_right_as_many(draw: Draw) -> None:
    block = ramp(8)
    block[..., 0] = np.linspace(1, 0, 8)[:, None, None]
    one, many = (seen(draw, block, SAMPLES, places=places) for places in (1, 6))
    assert np.abs(one - many).max() < 0.02


def test_long_steps_see_what_short_ones_see(draw: Draw, spoil: Callable) -> None:
    block = even(0.0, layers=32)
    block[5:7, 1, ..., 3], block[20, ..., :2, 3] = 0.5, 0.3
    long = draw({"sampling": STOCHASTIC, "voxels": STRAIGHT}, block)
    with spoil(FILE, "empty ? 255.0 * code - 0.99", "empty ? 0.0"):
        short = draw({"sampling": STOCHASTIC, "voxels": STRAIGHT}, block)
    np.testing.assert_allclose(long, short, atol=2e-3)
    assert short[..., 3].max() > 0.2
    with spoil(FILE, "empty ? 255.0 * code - 0.99", "empty ? 255.0 * code + 1.5"):
        assert np.abs(draw({"sampling": STOCHASTIC, "voxels": STRAIGHT}, block) - short).max() > 0.1


def test_lit_matter_against_the_reference(draw: Draw) -> None:
    """Bytes have 0.6 %, the chance of 512 samples 1.2."""
    right = reference(LIT, blobs(), tilted(), shadows=False)
    found = draw(LIT, blobs(), tilted(), size=24, samples=512)
    assert apart(found, right) < 0.016
    drawn = draw({**LIT, "order": {"kind": "fragment_lists"}}, blobs(), tilted(), size=24, samples=SAMPLES)
    assert apart(drawn, right) < 0.035, "cells drawn one by one are lit one by one"
