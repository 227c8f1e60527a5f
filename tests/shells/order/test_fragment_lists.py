"""Order by lists: as the walk's, through cycles too, and refused in words where there is no room."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.core.errors import LimitError
from tests.shells.conftest import even
from tests.shells.order.test_walk import GLOBE
from tests.shells.order.worlds import CYCLE, absorber_error, bars, difference, ordered, two_layers

Draw = Callable[..., np.ndarray]
FILE = "shells/order/fragment_lists.glsl"
LISTS = ordered("fragment_lists")


def test_an_even_absorber_over_a_hollow_sphere(draw: Draw) -> None:
    assert absorber_error(draw, LISTS) < 1e-5


def test_what_is_near_hides_what_is_far(draw: Draw) -> None:
    assert two_layers(draw, LISTS) == pytest.approx([0.6, 0.0, 0.24, 0.84], abs=1e-5)


@pytest.mark.parametrize("opaque", [False, True])
def test_it_is_the_order_of_the_walk(draw: Draw, opaque: bool) -> None:
    assert difference(draw, LISTS, {**GLOBE, "base": {"opaque": opaque}}).max() < 2e-3


def test_a_cycle_does_no_harm(draw: Draw) -> None:
    assert difference(draw, LISTS, CYCLE, 64, bars()).max() < 2e-3


def test_lists_without_room_are_refused(draw: Draw) -> None:
    with pytest.raises(LimitError, match=r"hold [\d,]+ fragments, and there is room for 1,000"):
        draw({**GLOBE, **ordered("fragment_lists", most=1000)}, even(0.1), size=32)


def test_lists_out_of_order_are_found(draw: Draw, spoil: Callable) -> None:
    with spoil(FILE, "list_fragment[place - 1].x > held.x", "list_fragment[place - 1].x < held.x"):
        assert (difference(draw, LISTS, GLOBE) > 0.01).mean() > 0.1
