"""The sun's window: it finds what the camera sees, faces the sun, and holds every point."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.forest.sun_view import fit, visible_points
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, REACH
from renderer.world.camera import Camera, Look, Orthographic
from tests.forest import worlds

RNG = np.random.default_rng(9)


def seen(camera: Camera) -> np.ndarray:
    return visible_points(camera, worlds.ground(), CELL, CANOPY_HEIGHT, REACH, (64, 64))


def test_a_view_from_above_sees_its_own_square() -> None:
    points = seen(Orthographic(centre=(100, 50, 0), width=200))
    assert points[:, 0].min() == pytest.approx(0, abs=10)
    assert points[:, 0].max() == pytest.approx(200, abs=10)
    assert points[:, 1].max() == pytest.approx(150, abs=10)
    # Distances grow geometrically, so that what is met is met late by a share of the way.
    assert points[:, 2].max() <= CANOPY_HEIGHT + 1e-6


def test_a_view_of_the_sky_sees_nothing() -> None:
    assert len(seen(Look(eye=(0, 0, 100), target=(0, 10, 110)))) == 0


@pytest.mark.parametrize(("azimuth", "elevation"), [(0, 90), (40, 60), (200, 12), (310, 2)])
def test_the_window_holds_every_point_and_faces_the_sun(azimuth: float, elevation: float) -> None:
    a, e = np.radians(azimuth), np.radians(elevation)
    sun = np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])
    points = RNG.uniform((-300, -200, 0), (500, 100, 60), (200, 3))
    view = fit(points, sun, worlds.ground(30.0), CELL, CANOPY_HEIGHT)
    assert view.right @ sun == pytest.approx(0, abs=1e-9 * view.size)
    assert view.up @ sun == pytest.approx(0, abs=1e-9 * view.size)
    assert view.right @ view.up == pytest.approx(0, abs=1e-6)
    assert np.linalg.norm(view.right) == pytest.approx(view.size)
    for side in (view.right, view.up):
        place = (points - view.corner) @ side / (side @ side)
        assert place.min() >= 0
        assert place.max() <= 1
    assert ((points - view.corner) @ sun).max() < 0, "what casts shadows lies before the window's plane"


def test_a_window_smaller_than_its_points_would_be_found() -> None:
    points = RNG.uniform((-300, -200, 0), (500, 100, 60), (200, 3))
    view = fit(points[:20] * 0.2, np.array([0.0, 0.0, 1.0]), worlds.ground(), CELL, CANOPY_HEIGHT)
    place = (points - view.corner) @ view.right / (view.right @ view.right)
    assert place.max() > 1


def test_with_nothing_in_sight_the_whole_land_is_taken() -> None:
    view = fit(np.zeros((0, 3)), np.array([0.0, 0.0, 1.0]), worlds.ground(), CELL, CANOPY_HEIGHT)
    assert view.size > 4000
