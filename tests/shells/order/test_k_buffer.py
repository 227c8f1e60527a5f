"""Order by windows: as the walk's where the rough order is at most k places off, and it says where it was not."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer.core.errors import LimitError
from renderer.shells import window
from renderer.shells.order import k_buffer
from renderer.world.camera import Orbit
from tests.shells.order.test_walk import GLOBE
from tests.shells.order.worlds import CYCLE, absorber_error, bars, difference, ordered, two_layers

Draw = Callable[..., np.ndarray]
FILE = "shells/order/k_buffer.glsl"
WINDOW = ordered("k_buffer", k=16)


@pytest.fixture
def wrong(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Numbers of pixels out of order, as pictures are drawn."""
    counts: list[int] = []
    inner = k_buffer.draw_through_windows

    def counting(*arguments: Any) -> int:
        counts.append(inner(*arguments))
        return counts[-1]

    monkeypatch.setattr(k_buffer, "draw_through_windows", counting)
    return counts


def test_an_even_absorber_over_a_hollow_sphere(draw: Draw) -> None:
    assert absorber_error(draw, ordered("k_buffer")) < 1e-5


def test_what_is_near_hides_what_is_far(draw: Draw) -> None:
    assert two_layers(draw, ordered("k_buffer")) == pytest.approx([0.6, 0.0, 0.24, 0.84], abs=1e-5)


@pytest.mark.parametrize("opaque", [False, True])
def test_a_window_as_deep_as_the_picture_is_the_order_of_the_walk(draw: Draw, opaque: bool, wrong: list[int]) -> None:
    assert difference(draw, WINDOW, {**GLOBE, "base": {"opaque": opaque}}).max() < 2e-3
    assert wrong == [0]


def test_it_counts_the_pixels_that_are_out_of_order(draw: Draw, wrong: list[int]) -> None:
    """Where a pixel differs from the walk, it was counted; a wider window leaves fewer."""
    off = [int((difference(draw, ordered("k_buffer", k=k), GLOBE) > 2e-3).sum()) for k in (1, 2, 4)]
    assert off[0] > 20
    assert off[0] <= wrong[0]
    assert wrong[0] > wrong[1] >= wrong[2] >= off[2]


def test_the_order_of_a_while_ago(draw: Draw, wrong: list[int]) -> None:
    """SXMPVO's own order needs no window; without one the middles' order is wrong."""
    assert difference(draw, ordered("k_buffer", k=1, presort="sxmpvo"), GLOBE).max() < 2e-3
    assert wrong == [0]


def test_an_order_is_kept_while_the_camera_moves_little(monkeypatch: pytest.MonkeyPatch) -> None:
    sorts: list[float] = []

    def sorting(frame: Any, fineness: float) -> Any:
        sorts.append(frame.state.camera.azimuth)
        return SimpleNamespace(cells=np.arange(3))

    monkeypatch.setattr(window, "sorted_for", sorting)
    rasters, place = SimpleNamespace(kept={}), SimpleNamespace(centre=np.zeros(3), radius=1.0)

    def asked(azimuth: float, shell: str = "one") -> None:
        camera = Orbit(target=(0, 0, 0), distance=3, azimuth=azimuth, elevation=0, field_of_view=40)
        state, renderer = SimpleNamespace(camera=camera), SimpleNamespace(rasters=rasters)
        frame: Any = SimpleNamespace(renderer=renderer, state=state, shell_key=shell, place=place)
        window.sorted_before(frame, 5.0)

    for azimuth in (0, 3, 4.9, 5.2, 9, 11):
        asked(azimuth)
    assert sorts == [0, 5.2, 11]
    asked(11, "another")
    assert sorts[3:] == [11]


def test_a_cycle_does_no_harm(draw: Draw) -> None:
    assert difference(draw, WINDOW, CYCLE, 64, bars()).max() < 2e-3


def test_windows_without_room_are_refused() -> None:
    window.check_room(100, 4, 3200)
    with pytest.raises(LimitError, match="at most 3 here"):
        window.check_room(100, 4, 3199)


def test_a_window_that_lets_the_wrong_one_fall_is_found(draw: Draw, spoil: Callable) -> None:
    with spoil(FILE, "there.x < held.x", "there.x > held.x && there.y >= 0.0 || there.y < 0.0"):
        assert (difference(draw, WINDOW, GLOBE) > 0.01).mean() > 0.05
