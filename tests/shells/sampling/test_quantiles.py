"""Few bytes a voxel, few lit places a ray: what is interpolated, whole steps or long ones, each share in its place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.shells.conftest import even, sigma
from tests.shells.sampling.test_adaptive import ramp
from tests.shells.test_against_reference import GLOBE, apart, blobs, reference, tilted

Draw = Callable[..., np.ndarray]
FILE = "shells/sampling/quantiles.glsl"
QUANTILES = {"kind": "quantiles", "rate": 1.0, "most": 256, "first_rays": 4}
STRAIGHT = {"interpolation": "straight", "storage": "float"}
LIT: dict[str, Any] = {
    **GLOBE, "sampling": {**QUANTILES, "rate": 2.0}, "voxels": STRAIGHT, "light": {"kind": "lambert"},
    "sun": {"kind": "direction", "azimuth": 60, "elevation": 35},
}  # fmt: skip


def seen(draw: Draw, block: np.ndarray, samples: int = 1, **sampling: float) -> np.ndarray:
    return draw({"sampling": {**QUANTILES, **sampling}, "voxels": STRAIGHT}, block, samples=samples)[4, 4]


@pytest.mark.parametrize("alpha", [0.004, 0.2, 0.9])
def test_even_matter_hides_by_its_length(draw: Draw, alpha: float) -> None:
    found = seen(draw, even(alpha, (0.2, 0.4, 0.8)))
    opacity = 1 - np.exp(-sigma(alpha) * 0.5)
    assert found[3] == pytest.approx(opacity, rel=0.01, abs=2e-4)
    np.testing.assert_allclose(found[:3], found[3] * np.array([0.2, 0.4, 0.8]), rtol=1e-3)


def test_empty_matter_is_nothing(draw: Draw) -> None:
    assert not seen(draw, even(0.0)).any()


def ramp_error(draw: Draw, samples: int) -> float:
    """Worst error where colour and opacity change with the height, so that the places that are lit count, too."""
    block = ramp(8)
    block[..., 0] = np.linspace(1, 0, 8)[:, None, None]
    right = draw({"sampling": {"kind": "adaptive", "rate": 16.0, "lit": 0.0, "jitter": 0.0, "most": 256},
                  "voxels": STRAIGHT}, block)[4, 4]  # fmt: skip
    return float(np.abs(seen(draw, block, samples) - right).max())


def test_the_mean_over_jitter_is_what_is_interpolated(draw: Draw, spoil: Callable) -> None:
    """Four shares of a ray's opacity, one place of each, err by 0.01."""
    assert ramp_error(draw, 32) < 0.012
    with spoil(FILE, "sampling_start = 0.5 +", "sampling_start = 0.9 +"):
        assert ramp_error(draw, 32) > 0.012
    with spoil(FILE, "there ? to - from : 0.0", "there ? 0.9 * (to - from) : 0.0"):
        assert ramp_error(draw, 32) > 0.02


def test_one_picture_is_near_the_mean(draw: Draw) -> None:
    assert ramp_error(draw, 1) < 0.05


def test_long_steps_see_what_short_ones_see(draw: Draw, spoil: Callable) -> None:
    block = even(0.0, layers=32)
    block[5:7, 1, ..., 3], block[20, ..., :2, 3] = 0.5, 0.3
    patch = {"sampling": {**QUANTILES, "rate": 2.0}, "voxels": STRAIGHT}
    long = draw(patch, block)
    with spoil("shells/coded.glsl", "-above / CODED_PER_VOXEL - 0.65", "0.0"):
        short = draw(patch, block)
    np.testing.assert_allclose(long, short, atol=2e-3)
    assert short[..., 3].max() > 0.2
    with spoil("shells/coded.glsl", "-above / CODED_PER_VOXEL - 0.65", "-above / CODED_PER_VOXEL + 2.0"):
        assert np.abs(draw(patch, block) - short).max() > 0.1


def lit_error(draw: Draw, places: int = 8) -> float:
    patch = {**LIT, "sampling": {**LIT["sampling"], "places": places}}
    right = reference(LIT, blobs(), tilted(), shadows=False)
    return apart(draw(patch, blobs(), tilted(), size=24, samples=32), right)


def test_lit_matter_against_the_reference(draw: Draw, spoil: Callable) -> None:
    """In thin matter of many colours, eight places err by 2 %, four by 4."""
    assert lit_error(draw) < 0.025
    assert lit_error(draw, 4) < 0.05
    with spoil(FILE, "mix(segment.near, segment.far, sampling_at[k])", "segment.near"):
        assert lit_error(draw) > 0.03


def test_cells_drawn_one_by_one_are_lit_one_by_one(draw: Draw) -> None:
    drawn = draw({**LIT, "order": {"kind": "fragment_lists"}}, blobs(), tilted(), size=24, samples=32)
    assert apart(drawn, reference(LIT, blobs(), tilted(), shadows=False)) < 0.035
