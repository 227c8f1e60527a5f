"""Without a shadow all of the sun reaches the ground under thick matter."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tests.shells.shadow.slabs import lit

Draw = Callable[..., np.ndarray]


def test_depth_does_not_count(draw: Draw) -> None:
    assert abs(lit(draw, {"kind": "none"}, 6.0) / lit(draw, {"kind": "none"}, 12.0) - 1) < 0.01


def test_a_shadow_would_be_found(draw: Draw, spoil: Callable) -> None:
    bright = lit(draw, {"kind": "none"}, 6.0)
    with spoil("shells/shadow/none.glsl", "return 1.0;", "return 0.3;"):
        assert lit(draw, {"kind": "none"}, 6.0) < 0.9 * bright
