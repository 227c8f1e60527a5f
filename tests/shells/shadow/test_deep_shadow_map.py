"""Deep shadow map: light inside an even slab against its closed form, and a curve that is read wrongly."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.shells.conftest import even
from tests.shells.shadow.slabs import share, sun_share

Draw = Callable[..., np.ndarray]
DEEP: dict[str, Any] = {"kind": "deep_shadow_map", "resolution": 128, "bias": 0.0}


@pytest.mark.parametrize(("depth", "elevation"), [(1.0, 90.0), (4.0, 60.0), (0.3, 45.0)])
def test_an_even_slab(draw: Draw, depth: float, elevation: float) -> None:
    assert sun_share(draw, DEEP, depth, elevation) == pytest.approx(share(depth, elevation), abs=0.03)


def test_the_ground_lies_in_the_shadow_of_what_is_opaque(draw: Draw) -> None:
    block = even(0.0, layers=16)
    block[8:10, :, :, 3] = 0.9999
    patch = {
        "light": {"kind": "lambert"},
        "base": {"opaque": True, "colour": [1, 1, 1]},
        "sun": {"kind": "direction", "azimuth": 90.0, "elevation": 60.0},
        "camera": {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, 1], "up": [0, 1, 0], "width": 0.5},
    }
    below = draw({**patch, "base": {"opaque": False}, "shadow": DEEP}, block)[4, 4, 1]
    bright = draw({**patch, "base": {"opaque": False}, "shadow": {"kind": "none"}}, block)[4, 4, 1]
    assert below < 0.75 * bright


@pytest.mark.parametrize(
    ("right", "wrong"),
    [("return exp(-depth);", "return 1.0 - depth;"), ("float t = dot(from", "float t = 0.8 * dot(from")],
)
def test_a_curve_that_is_read_wrongly_is_found(draw: Draw, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("shells/shadow/deep_shadow_map.glsl", right, wrong):
        assert abs(sun_share(draw, DEEP, 4.0, 60.0) - share(4.0, 60.0)) > 0.05
