"""Bytes: 256 steps up to white, bands and lost haze as the thesis shows them, by walking and by drawn cells alike."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.conftest import even

Draw = Callable[..., np.ndarray]
FILE = "shells/accumulation/bytes.glsl"
WHITE = 4.0


def drawn(draw: Draw, alpha: float, order: str = "walk") -> np.ndarray:
    patch = {
        "order": {"kind": order},
        "sampling": {"kind": "uniform", "samples": 1},
        "accumulation": {"kind": "bytes", "white": WHITE},
    }
    return np.asarray(draw(patch, even(alpha, (0.9, 0.2, 3.0))))


@pytest.mark.parametrize("order", ["walk", "sxmpvo"])
def test_there_are_256_steps_up_to_white(draw: Draw, order: str) -> None:
    found = drawn(draw, 0.2, order) / [WHITE, WHITE, WHITE, 1] * 255
    assert found == pytest.approx(np.round(found), abs=1e-3)
    assert found[4, 4].min() > 1


def test_haze_is_lost(draw: Draw) -> None:
    """The failure of section 5.2.2: each segment adds less than a byte could hold."""
    assert not drawn(draw, 1e-4).any()


def test_more_steps_are_found(draw: Draw, spoil: Callable) -> None:
    with spoil(FILE, "* 255.0 + 0.5) / 255.0", "* 1023.0 + 0.5) / 1023.0"):
        assert drawn(draw, 1e-3).any()
