"""The sun's windows: they find what the camera sees, face the sun, hold every point, and stand still where asked."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.forest.sun_view import Light, Window, depths, fit, light_of, or_whole_land, snapped, visible_points
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, REACH
from renderer.world.camera import Camera, Look, Orthographic
from tests.forest import worlds

RNG = np.random.default_rng(9)
SUNS = [(0, 90), (40, 60), (200, 12), (310, 2)]


def seen(camera: Camera) -> np.ndarray:
    return visible_points(camera, worlds.ground(), CELL, CANOPY_HEIGHT, REACH, (64, 64))


def to_sun(azimuth: float, elevation: float) -> np.ndarray:
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])


def light(azimuth: float = 200, elevation: float = 12) -> Light:
    return light_of(to_sun(azimuth, elevation), worlds.ground(30.0), CELL, CANOPY_HEIGHT)


def inside(window: Window, across: np.ndarray) -> bool:
    place = (across - window.low) / window.sides
    return bool((place >= 0).all() and (place <= 1).all())


def test_a_view_from_above_sees_its_own_square() -> None:
    points = seen(Orthographic(centre=(100, 50, 0), width=200))
    assert points[:, 0].min() == pytest.approx(0, abs=10)
    assert points[:, 0].max() == pytest.approx(200, abs=10)
    assert points[:, 1].max() == pytest.approx(150, abs=10)
    # Distances grow geometrically, so that what is met is met late by a share of the way.
    assert points[:, 2].max() <= CANOPY_HEIGHT + 1e-6


def test_a_view_of_the_sky_sees_nothing_and_takes_the_whole_land() -> None:
    points = seen(Look(eye=(0, 0, 100), target=(0, 10, 110)))
    assert len(points) == 0
    land = or_whole_land(points, worlds.ground(), CELL, CANOPY_HEIGHT)
    assert np.ptp(land, axis=0) == pytest.approx([4088, 4088, CANOPY_HEIGHT])
    np.testing.assert_array_equal(or_whole_land(land[:3], worlds.ground(), CELL, CANOPY_HEIGHT), land[:3])


@pytest.mark.parametrize(("azimuth", "elevation"), SUNS)
def test_the_light_is_square_and_starts_beyond_the_land(azimuth: float, elevation: float) -> None:
    sun, found = to_sun(azimuth, elevation), light(azimuth, elevation)
    axes = np.stack([found.right, found.up, sun])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert found.right[2] == 0
    corners = np.array([[x, y, 50.0] for x in (-2044, 2044) for y in (-2044, 2044)])
    assert (corners @ sun).max() < found.away


@pytest.mark.parametrize("margin", [0.0, 10.0])
def test_a_window_holds_its_points_closely(margin: float) -> None:
    points = RNG.uniform((-300, -200, 0), (500, 100, 60), (200, 3))
    across = light().across(points)
    found = fit(points, light(), margin)
    assert inside(found, across)
    assert found.sides == pytest.approx(1.02 * np.ptp(across, axis=0) + 2 * margin)
    assert not inside(fit(points[:20] * 0.2, light(), margin), across), "a window too small would be found"


def test_texels_start_at_the_corner() -> None:
    assert Window((-3.0, 4.0), (64.0, 32.0)).texels(16) == (-3.0, 4.0, 4.0, 2.0)


def test_a_snapped_window_moves_by_whole_texels_and_keeps_its_size() -> None:
    grids = []
    for shift in np.linspace(0, 40, 81):
        across = RNG.uniform((-300 + shift, 0), (500 + shift, 100), (200, 2))
        loose = Window((-300 + shift, 0.3 * shift), (800.0, 100.0))
        found = snapped(loose, 512)
        assert inside(found, np.clip(across, loose.low, np.add(loose.low, loose.sides)))
        step = np.array(found.sides) / 512
        grids.append(step)
        np.testing.assert_allclose(np.array(found.low) / step, np.rint(np.array(found.low) / step), atol=1e-9)
    assert len(np.unique(np.array(grids), axis=0)) == 1, "the same texels in the world for every place"
    assert (np.array(grids[0]) * 512 <= 2**0.25 * np.array([800.0, 100.0]) * 512 / 511 + 1e-9).all()


def test_depths_are_measured_before_the_camera() -> None:
    camera = Look(eye=(10, 0, 5), target=(10, 100, 5))
    points = np.array([[10.0, 30.0, 5.0], [90.0, 30.0, 50.0], [10.0, -4.0, 5.0]])
    np.testing.assert_allclose(depths(camera, points), [30, 30, -4], atol=1e-12)
