"""How voxels are kept: bytes hold what is dense, and thin matter is kept more finely by itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tests.shells.conftest import even, sigma

Draw = Callable[..., np.ndarray]


def error(draw: Draw, alpha: float, storage: str) -> float:
    """Relative error of the opacity of an even slab."""
    found = draw({"voxels": {"interpolation": "straight", "storage": storage}}, even(alpha), size=16)[..., 3]
    return float(np.abs(found / (1 - np.exp(-sigma(alpha) * 0.5)) - 1).max())


@pytest.mark.parametrize("alpha", [0.004, 0.02, 0.09, 0.5])
def test_what_is_chosen_holds_the_opacity(draw: Draw, alpha: float) -> None:
    assert error(draw, alpha, "auto") < 0.01


def test_bytes_would_not_hold_thin_matter(draw: Draw) -> None:
    assert error(draw, 0.004, "bytes") > 0.05
