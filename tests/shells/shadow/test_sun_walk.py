"""Walk to the sun: light inside an even slab against its closed form, and ways that go wrong."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.shells.shadow.slabs import share, sun_share

Draw = Callable[..., np.ndarray]
WALK: dict[str, Any] = {"kind": "sun_walk", "resolution": 64}


@pytest.mark.parametrize(("depth", "elevation"), [(1.0, 90.0), (4.0, 60.0), (0.3, 45.0)])
def test_an_even_slab(draw: Draw, depth: float, elevation: float) -> None:
    assert sun_share(draw, WALK, depth, elevation) == pytest.approx(share(depth, elevation), abs=0.03)


@pytest.mark.parametrize(
    ("file", "right", "wrong"),
    [
        ("shells/shadow/sun_walk.glsl", "depth += matter_extinction", "depth += 0.3 * matter_extinction"),
        ("shells/shadow/sun_walk.glsl", "float enter = 0.0, depth", "float enter = 0.05, depth"),
    ],
)
def test_a_wrong_way_is_found(draw: Draw, spoil: Callable, file: str, right: str, wrong: str) -> None:
    with spoil(file, right, wrong):
        assert abs(sun_share(draw, WALK, 4.0, 60.0) - share(4.0, 60.0)) > 0.05
