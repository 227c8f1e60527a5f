"""Directions of a hemisphere: counted as the thesis counts, evenly set, found again, and the same in GLSL."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.directional.hemisphere import LAYOUTS, Hemisphere, hemisphere_of


@pytest.mark.parametrize("count", LAYOUTS)
def test_directions_are_counted_as_in_the_thesis(count: int) -> None:
    layout = hemisphere_of(count)
    directions = layout.directions()
    assert layout.count == count == len(directions)  # errata 003-2: 16 x 8 + 1, 32 x 16 + 1
    np.testing.assert_allclose(np.linalg.norm(directions, axis=1), 1, rtol=1e-12)
    assert (directions[:, 2] > 0).all()
    assert tuple(directions[-1]) == (0, 0, 1)


@pytest.mark.parametrize("count", LAYOUTS)
def test_each_direction_lies_in_its_own_cell(count: int) -> None:
    layout = hemisphere_of(count)
    assert (layout.nearest(layout.directions()) == np.arange(count)).all()


def test_cells_hold_what_their_solid_angles_say() -> None:
    layout = Hemisphere(16, 8)
    random = np.random.default_rng(3)
    z, turn = random.random(400_000), random.random(400_000) * 2 * np.pi
    level = np.sqrt(1 - z * z)
    found = np.bincount(layout.nearest(np.stack([level * np.cos(turn), level * np.sin(turn), z], axis=-1)))
    share = layout.solid_angles() / (2 * np.pi)
    assert share.sum() == pytest.approx(1, rel=1e-12)
    error = np.sqrt(share * (1 - share) / 400_000)
    assert np.abs(found / 400_000 - share).max() < 5 * error.max()


def test_what_is_below_the_horizon_counts_as_level() -> None:
    layout = Hemisphere(16, 8)
    assert layout.nearest(np.array([0.6, 0.0, -0.8])) == layout.nearest(np.array([1.0, 0.0, 0.0])) == 0


@pytest.mark.parametrize("count", LAYOUTS)
def test_a_cell_lies_between_its_four_directions(count: int) -> None:
    layout = hemisphere_of(count)
    cells, directions = layout.cells(), layout.directions()
    middle = directions[cells].sum(axis=1)
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    for corner in range(4):
        number = cells[:, corner]
        towards = middle + 3 * directions[number]
        np.testing.assert_array_equal(layout.nearest(towards / np.linalg.norm(towards, axis=1, keepdims=True)), number)
