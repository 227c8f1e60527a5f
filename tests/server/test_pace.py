from __future__ import annotations

import pytest

from server.pace import Allowance, Movers, ScaleController, scaled


def settled(full_ms: float, frame_ms: float) -> list[float]:
    """Scales of 40 frames of a renderer whose full picture takes `full_ms`."""
    controller = ScaleController(frame_ms)
    scales = []
    for _ in range(40):
        scales.append(controller.scale)
        controller.observe(full_ms * controller.scale**2, controller.scale)
    return scales


@pytest.mark.parametrize(
    ("full_ms", "expected"),
    [(10, 1.0), (28, 1.0), (50, 0.6875), (84, 0.5625), (112, 0.5), (180, 0.5), (220, 0.4375), (1000, 0.375)],
)
def test_the_scale_holds_the_frame_time_and_does_not_swing(full_ms: float, expected: float) -> None:
    # sqrt(28 / 50) = 0.748, with a tenth of headroom 0.71: the step below is 11/16.
    scales = settled(full_ms, 28)
    assert scales[-1] == pytest.approx(expected, abs=1 / 16 + 1e-9)
    assert len(set(scales[10:])) == 1
    # Half the resolution is left only for as many pictures as make a movement: 45 ms each.
    assert full_ms * scales[-1] ** 2 <= (28 if scales[-1] > 0.5 else 45) or scales[-1] == 0.375


def test_one_slow_frame_costs_no_resolution_but_two_do() -> None:
    controller = ScaleController(28)
    for cost in (20, 20, 900, 20):
        controller.observe(cost, 1.0)
        assert controller.scale == 1.0
    controller.observe(900, 1.0)
    assert controller.scale == 0.375


def test_the_scale_comes_back_when_the_scene_gets_cheap() -> None:
    controller = ScaleController(28)
    for _ in range(3):
        controller.observe(400, 1.0)
    assert controller.scale == 0.375
    for _ in range(3):
        controller.observe(10 * 0.375**2, 0.375)
    assert controller.scale == 1.0


def test_the_expected_cost_is_that_of_a_full_picture() -> None:
    controller = ScaleController(28)
    assert controller.expected_ms is None
    controller.observe(20, 0.5)
    assert controller.expected_ms == pytest.approx(80)


def test_a_view_counts_as_moving_for_a_moment_and_only_to_others() -> None:
    class View:
        """Stands for a live view."""

    movers, one, two = Movers(), View(), View()
    movers.note(one, 10.0)
    assert movers.others(two, 10.2)
    assert not movers.others(one, 10.2)
    assert not movers.others(two, 10.4)
    movers.note(one, 20.0)
    del one
    assert not movers.others(two, 20.1), "a view that left moves no more"


def test_a_size_is_rounded_and_never_empty() -> None:
    assert scaled(512, 300, 0.5625) == (288, 169)
    assert scaled(1, 1, 0.5) == (1, 1)


def test_an_allowance_lets_a_burst_through_then_the_rate() -> None:
    allowance = Allowance(10, 0.0)
    assert [allowance.take(0.0) for _ in range(11)] == [True] * 10 + [False]
    assert [allowance.take(0.25) for _ in range(3)] == [True, True, False]
    assert allowance.take(100.0)
    assert [allowance.tell(at) for at in (0.0, 0.5, 1.1)] == [True, False, True]
