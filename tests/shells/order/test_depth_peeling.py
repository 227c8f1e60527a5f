"""Order by peeling: as the walk's, pixel by pixel, one layer a pass."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.shells import peeling
from tests.shells.conftest import even
from tests.shells.order.test_walk import GLOBE
from tests.shells.order.worlds import absorber_error, difference, ordered, two_layers

Draw = Callable[..., np.ndarray]
FILE = "shells/order/depth_peeling.glsl"
PEELING = ordered("depth_peeling")


def test_an_even_absorber_over_a_hollow_sphere(draw: Draw) -> None:
    assert absorber_error(draw, PEELING) < 1e-5


def test_what_is_near_hides_what_is_far(draw: Draw) -> None:
    assert two_layers(draw, PEELING) == pytest.approx([0.6, 0.0, 0.24, 0.84], abs=1e-5)


@pytest.mark.parametrize("opaque", [False, True])
def test_it_is_the_order_of_the_walk(draw: Draw, opaque: bool) -> None:
    """The walk ends at an opacity of 0.999: what it leaves out is 0.001 of the light behind."""
    assert difference(draw, PEELING, {**GLOBE, "base": {"opaque": opaque}}).max() < 2e-3


def test_it_takes_a_pass_for_each_layer(draw: Draw, monkeypatch: pytest.MonkeyPatch) -> None:
    """A ray straight down meets the three cells of a prism, and fewer where it meets an edge."""
    seen: list[Any] = []
    peel = peeling.peel
    monkeypatch.setattr("renderer.shells.order.depth_peeling.peel", lambda *of: seen.append(peel(*of)) or seen[-1])
    draw(PEELING, even(0.5))
    assert seen == [3]
    draw(ordered("depth_peeling", passes=2), even(0.5))
    assert seen[1:] == [2]


def test_layers_that_overlap_are_found(draw: Draw, spoil: Callable) -> None:
    with spoil(FILE, "t <= last", "t <= last + 0.05"):
        assert absorber_error(draw, PEELING) > 0.01
