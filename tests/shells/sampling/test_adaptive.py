"""Adaptive samples: a ramp of extinction in closed form, and thin layers that are not missed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.conftest import even, sigma

Draw = Callable[..., np.ndarray]
FILE = "shells/sampling/adaptive.glsl"


def ramp(layers: int) -> np.ndarray:
    """Extinction that rises from nothing at the base to 3 / m at the top, by the middles of its layers."""
    block = even(0.0, layers=layers)
    height = (np.arange(layers) + 0.5) / layers
    block[..., 3] = (1 - np.exp(-3.0 * height * 0.1))[:, None, None]
    return block


def opacity(draw: Draw, block: np.ndarray) -> float:
    return float(draw({"sampling": {"kind": "adaptive", "jitter": 0.0, "most": 256}}, block)[4, 4, 3])


def test_a_ramp_of_extinction(draw: Draw) -> None:
    assert opacity(draw, ramp(16)) == pytest.approx(1 - np.exp(-1.5 * 0.5), abs=1e-3)


def test_thin_layers_are_met(draw: Draw) -> None:
    block = even(0.0, layers=64)
    block[20:22, ..., 3] = 0.5
    assert opacity(draw, block) == pytest.approx(1 - np.exp(-sigma(0.5) * 2 * 0.5 / 64), abs=0.01)


def test_empty_matter_is_nothing(draw: Draw) -> None:
    assert not draw({}, even(0.0)).any()


@pytest.mark.parametrize(
    ("right", "wrong"), [("float lambda = (0.5 +", "float lambda = (1.0 +"), ("* sampling_rate)", "* 0.02)")]
)
def test_shifted_and_too_few_samples_are_found(draw: Draw, spoil: Callable, right: str, wrong: str) -> None:
    block = ramp(8)
    block[2:4, ..., 3] = 0.6
    truth = opacity(draw, block)
    with spoil(FILE, right, wrong):
        assert abs(opacity(draw, block) - truth) > 0.01
