"""No order but moments: opacity exact, colours near, and nearer than by weights of depth or as they come."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.shells.order_errors import order_error
from tests.shells.conftest import even
from tests.shells.order.test_walk import GLOBE
from tests.shells.order.worlds import absorber_error, ordered, patches, two_layers

Draw = Callable[..., np.ndarray]
FILE = "shells/order/moments.glsl"
MOMENTS = ordered("moments")
RETURN = "return clamp(exp(-b_0 * share), 0.0, 1.0);"


def off(draw: Draw, order: dict[str, Any], opacity: float = 1.0) -> float:
    """Relative RMSE of patches over a hollow sphere, against the walk."""
    block = patches()
    block[..., 3] *= opacity
    return order_error(draw({**GLOBE, **order}, block, size=48), draw(GLOBE, block, size=48)).relative_rmse


def test_opacity_is_exact(draw: Draw) -> None:
    assert absorber_error(draw, MOMENTS) < 1e-5


def test_matter_of_one_colour_is_exact(draw: Draw) -> None:
    one, other = (draw({**GLOBE, **order}, even(0.1, (0.2, 0.5, 0.9)), size=16) for order in (MOMENTS, {}))
    assert one == pytest.approx(other, abs=1e-5)


def test_two_layers_are_told_apart(draw: Draw) -> None:
    """Two depths are within what four moments know; only a layer's own absorbance is guessed at."""
    assert two_layers(draw, MOMENTS) == pytest.approx([0.6, 0.0, 0.24, 0.84], abs=0.01)
    assert two_layers(draw, ordered("moments", overestimation=0.0)) == pytest.approx([0.6, 0.0, 0.24, 0.84], abs=1e-3)


def test_it_is_near_the_walk(draw: Draw) -> None:
    """2.3 % of dense and 0.5 % of thin patches."""
    assert off(draw, MOMENTS) < 0.035
    assert off(draw, MOMENTS, 0.3) < 0.01
    assert off(draw, ordered("none", depth=False)) > 0.1


@pytest.mark.parametrize(
    "weight",
    [
        "return 1.0;",
        "return clamp(3.0e3 * pow(0.5 - 0.5 * depth, 3.0), 1.0e-2, 3.0e3);",
        "return clamp(exp(b_0 * share), 0.0, 1.0);",
    ],
    ids=["all alike", "McGuire & Bavoil 2013, equation 10", "sign"],
)
def test_other_weights_are_found(draw: Draw, spoil: Callable, weight: str) -> None:
    with spoil(FILE, RETURN, weight):
        assert off(draw, MOMENTS) > 0.05
