"""Single precision: many faint segments add up to what they should."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.conftest import even, sigma

Draw = Callable[..., np.ndarray]


def opacity(draw: Draw) -> float:
    """Of a haze in which each segment adds less than a byte could hold."""
    return float(draw({"sampling": {"kind": "uniform", "samples": 1}}, even(1e-4))[4, 4, 3])


def test_faint_matter_is_not_lost(draw: Draw) -> None:
    assert opacity(draw) == pytest.approx(1 - np.exp(-sigma(1e-4) * 0.5), rel=5e-4)  # float32 knows 1 - exp no better


def test_rounding_would_be_found(draw: Draw, spoil: Callable) -> None:
    with spoil("shells/accumulation/single.glsl", "return sum;", "return floor(sum * 255.0 + 0.5) / 255.0;"):
        assert opacity(draw) == 0.0
