"""Shadow map: whole shadows of opaque layers, and the speckles of too small a bias inside of matter."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.shells.conftest import even
from tests.shells.shadow.slabs import sun_share

Draw = Callable[..., np.ndarray]
FILE = "shells/shadow/shadow_map.glsl"


def below(draw: Draw, shadow: dict[str, Any]) -> float:
    """Light under an opaque layer, seen from below."""
    block = even(0.0, layers=16)
    block[:4, ..., 3], block[8:10, ..., 3] = 0.3, 0.9999
    sun = {"kind": "direction", "azimuth": 90.0, "elevation": 60.0}
    up = {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, 1], "up": [0, 1, 0], "width": 0.2}
    return float(draw({"light": {"kind": "lambert"}, "sun": sun, "camera": up, "shadow": shadow}, block)[4, 4, 1])


def shadow(**given: float) -> dict[str, Any]:
    return {"kind": "shadow_map", "resolution": 128, **given}


def test_an_opaque_layer_casts_a_whole_shadow(draw: Draw) -> None:
    exact = {"kind": "sun_walk", "resolution": 64}
    assert below(draw, shadow(resolution=1024)) == pytest.approx(below(draw, exact), rel=0.08)


def test_what_is_thin_casts_none_or_all(draw: Draw) -> None:
    """The failure: half of the sun is never left."""
    none, every = (sun_share(draw, shadow(opacity=part, bias=0.0), 0.6, 90.0) for part in (0.9, 0.02))
    assert none == pytest.approx(1.0, abs=0.01)
    assert every < 0.15


def acne(draw: Draw, bias: float) -> float:
    """Spread of the light over even, thick matter in a slanting sun, as a share of its mean."""
    sun = {"kind": "direction", "azimuth": 70.0, "elevation": 35.0}
    patch = {"light": {"kind": "lambert"}, "sun": sun, "shadow": shadow(opacity=0.3, bias=bias)}
    found = draw(patch, even(0.8, layers=16), size=32)[8:24, 8:24, 1]
    return float(found.std() / found.mean())


def test_acne_goes_with_bias(draw: Draw) -> None:
    """The failure: texels' steps shade the matter that they stand for."""
    assert acne(draw, 0.0) > 5 * acne(draw, 8.0)


def test_a_turned_comparison_is_found(draw: Draw, spoil: Callable) -> None:
    with spoil(FILE, "? 0.0 : 1.0", "? 1.0 : 0.0"):
        assert below(draw, shadow()) > 1.2 * below(draw, {"kind": "sun_walk", "resolution": 64})
