"""Slices: corrected, they let through what the slab does at any angle; otherwise, what their number says."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.forest.geometry.slices import Slices
from tests.forest import worlds
from tests.forest.slabs import ALPHA, NOISE, slab_error, trace
from tests.forest.truth import MARCH, Judge

Ask = Callable[..., np.ndarray]
DIRECTIONS = [(0, 0, -1), (0.6, 0, -0.8), (-0.5, 0.6, -0.5)]


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("count", [8, 32, 64])
def test_corrected_slices_are_the_slab(ask: Ask, direction: tuple[float, ...], count: int) -> None:
    assert slab_error(ask, Slices(count=count), direction) < NOISE


def test_corrected_slices_are_the_slab_on_a_slope(ask: Ask) -> None:
    for slope in (0.5, -0.5):
        assert slab_error(ask, Slices(), (0.5, 0.3, -0.8), slope) < NOISE


@pytest.mark.parametrize("count", [8, 32])
def test_uncorrected_slices_depend_on_their_number_and_not_on_the_angle(ask: Ask, count: int) -> None:
    for direction in DIRECTIONS:
        found = trace(ask, Slices(count=count, correct_opacity=False), (0, 0, 20.0), direction, worlds.uniform(ALPHA))
        assert found[:, 0].mean() == pytest.approx((1 - ALPHA / 255) ** count, abs=NOISE)


def test_uncorrected_slices_fail_where_corrected_ones_hold(ask: Ask) -> None:
    assert slab_error(ask, Slices(correct_opacity=False), DIRECTIONS[1]) > 10 * NOISE


@pytest.mark.parametrize(("right", "wrong"), [
    ("spacing / max(abs(climb), 0.02)", "spacing * max(abs(climb), 0.02)"),
    ("1.0 - pow(1.0 - opacity_of(voxel), path)", "1.0 - pow(opacity_of(voxel), path)"),
    ("above / spacing - 0.5", "above / spacing - 1.5"),
])
def test_a_wrong_sheet_is_found(ask: Ask, spoil: Callable, right: str, wrong: str) -> None:
    with spoil("forest/geometry/slices.glsl", right, wrong):
        assert slab_error(ask, Slices(count=8), DIRECTIONS[1]) > NOISE


def test_sheets_lie_at_the_middle_of_their_share(ask: Ask) -> None:
    """Twin: an opaque canopy is met at the first sheet below the eye, h = (k + 1/2) / N."""
    for start, count in ((20.0, 8), (13.0, 10), (9.0, 32)):
        found = trace(ask, Slices(count=count), (0, 0, start), (0.4, 0.1, -0.9), worlds.uniform(255))
        sheet = np.ceil(start / 20.0 * count - 0.5) - 1
        np.testing.assert_allclose(found[:, 2], (sheet + 0.5) / count, atol=1e-5)
        np.testing.assert_allclose(found[:, 3], (sheet + 0.5) / count * 20.0, atol=2e-3)


def test_distance_to_the_reference(judge: Judge) -> None:
    judge.holds(
        "geometry", "slices",
        MARCH,
        0.026,  # 32 sheets: matter between two of them is not met, and one stands for its whole share
    )


def test_uncorrected_slices_cost_more(judge: Judge) -> None:
    plain = {"geometry": worlds.technique("geometry", "slices", correct_opacity=False)}
    assert judge.distance("geometry", "slices", **plain) > 1.1 * (MARCH + 0.036)


def test_picture(judge: Judge) -> None:
    judge.looks("geometry", "slices")
