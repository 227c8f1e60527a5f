"""Half precision: numpy's rounding for one segment; haze by many segments is nearly right."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.conftest import even, sigma

Draw = Callable[..., np.ndarray]
FILE = "shells/accumulation/half.glsl"
FLAT = {"surface": {"kind": "plane", "size": 2.0, "divisions": 1}, "sampling": {"kind": "uniform", "samples": 1}}


def drawn(draw: Draw, alpha: float, kind: str) -> np.ndarray:
    return np.asarray(draw({**FLAT, "accumulation": {"kind": kind}}, even(alpha, (0.3, 0.02, 7.0)))[..., :])


def test_it_rounds_as_halves_do(draw: Draw) -> None:
    kept, whole = drawn(draw, 0.07, "half"), drawn(draw, 0.07, "single")
    assert kept == pytest.approx(whole, rel=3 * 2.0**-11)
    assert (kept == kept.astype(np.float16)).all()
    assert (kept != whole).any()


def test_haze_is_not_lost(draw: Draw) -> None:
    assert drawn(draw, 1e-4, "half")[4, 4, 3] == pytest.approx(1 - np.exp(-sigma(1e-4) * 0.5), rel=2e-3)


def test_fewer_digits_are_found(draw: Draw, spoil: Callable) -> None:
    with spoil(FILE, "- 10.0", "- 5.0"):
        assert drawn(draw, 0.07, "half") != pytest.approx(drawn(draw, 0.07, "single"), rel=3 * 2.0**-11)
