"""What a click tells about the ground under it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from renderer.forest.probe import eye_above, horizon
from renderer.forest.world_scale import CELL

SIZE = 65
HALF = (SIZE - 1) / 2 * CELL
MIDDLE = np.zeros(3)


def test_open_level_ground_has_its_horizon_at_zero() -> None:
    elevations, azimuths = horizon(np.zeros((SIZE, SIZE)), eye_above(np.zeros((SIZE, SIZE)), MIDDLE))
    assert np.all(elevations == 0)
    assert azimuths[18] == pytest.approx(math.pi / 2), "clockwise from north, every five degrees"


def test_a_wall_in_the_east_stands_at_its_own_angle() -> None:
    surface = np.zeros((SIZE, SIZE))
    east = np.arange(SIZE) * CELL - HALF
    surface[:, east >= 100] = 50.0
    elevations, _ = horizon(surface, MIDDLE)
    first = east[east >= 100][0]
    # The search meets the bilinear slope before the wall's own node: within a cell of it.
    assert math.atan2(50, first + CELL) <= elevations[18] <= math.atan2(50, first - CELL)
    assert elevations[54] == 0, "nothing stands in the west"


def test_within_a_level_wood_one_looks_round_from_the_treetops() -> None:
    surface = np.full((SIZE, SIZE), 20.0)
    eye = eye_above(surface, MIDDLE)
    assert eye[2] == 20
    assert np.all(horizon(surface, eye)[0] == 0)
    assert horizon(surface, MIDDLE)[0].min() > math.radians(70), "from the ground, trees would hide the sky all round"
