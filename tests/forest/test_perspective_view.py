"""The perspective map's homography: it holds what is seen, is fine near the eye, and equals the two projections."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.forest.perspective_view import MARGIN, PerspectiveMap, perspective_map
from renderer.forest.sun_view import Light, light_of
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL
from renderer.world.camera import Camera, Look, Orthographic, pose
from tests.forest import worlds

RNG = np.random.default_rng(4)
CAMERA = Look(eye=(0, -50, 40), target=(0, 400, 0), field_of_view=50)
SUNS = [(0, 90), (90, 30), (270, 12), (10, 40), (185, 35), (0, 6), (165, 10)]
"""From above, from the sides, from ahead, from behind, and into the view."""


def to_sun(azimuth: float, elevation: float) -> np.ndarray:
    a, e = np.radians(azimuth), np.radians(elevation)
    return np.array([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)])


def ahead() -> np.ndarray:
    """Points (360, 3) up to 20 m over level ground inside the camera's view, from 60 to 1500 m off."""
    far = np.geomspace(60, 1500, 40)
    aside = np.linspace(-0.4, 0.4, 9)
    x, z = (far[:, None] * aside).ravel(), RNG.uniform(0, 20, 360)
    return np.stack([x, np.repeat(far, 9) - 50, z], axis=-1)


SEEN = ahead()


def made(azimuth: float, elevation: float, camera: Camera = CAMERA, slide: float = 0.0) -> tuple[PerspectiveMap, Light]:
    sun = to_sun(azimuth, elevation)
    light = light_of(sun, worlds.ground(), CELL, CANOPY_HEIGHT)
    return perspective_map(camera, SEEN, light, sun, slide), light


def places(found: PerspectiveMap, light: Light, points: np.ndarray) -> np.ndarray:
    across = np.concatenate([light.across(points) - found.anchor, np.ones((len(points), 1))], axis=1)
    projected = across @ found.to_map.T
    assert (projected[:, 2] > 0).all()
    return np.asarray(projected[:, :2] / projected[:, 2:])


@pytest.mark.parametrize(("azimuth", "elevation"), SUNS)
def test_everything_seen_has_a_place_on_the_map(azimuth: float, elevation: float) -> None:
    found, light = made(azimuth, elevation)
    place = places(found, light, SEEN)
    edge = MARGIN / (1 + 2 * MARGIN)
    np.testing.assert_allclose(place.min(axis=0), edge, atol=1e-6)
    np.testing.assert_allclose(place.max(axis=0), 1 - edge, atol=1e-6)
    np.testing.assert_allclose(found.to_map @ found.to_light, np.eye(3), atol=1e-6 * np.abs(found.to_map).max())


@pytest.mark.parametrize(("azimuth", "elevation"), [(90, 30), (270, 12), (0, 90)])
def test_texels_are_finer_near_the_eye(azimuth: float, elevation: float) -> None:
    found, light = made(azimuth, elevation)
    near, far = np.array([[0.0, 30.0, 10.0]]), np.array([[0.0, 1300.0, 10.0]])

    def width(point: np.ndarray) -> float:
        first, second = places(found, light, np.concatenate([point, point + [[0.0, 0.1, 0.0]]]))
        return 0.1 / float(np.linalg.norm(second - first))

    assert width(far) > 10 * width(near)


def test_lines_through_the_cameras_projection_stay_lines_of_the_map() -> None:
    """The published way, step by step: camera's projection, the sun's place after it, the image plane of a lamp there.

    Four points fix a homography; the fifth and all others must then agree.
    """
    found, light = made(90, 30)
    placed, points = pose(CAMERA), SEEN
    relative = points - placed.eye
    depth = relative @ placed.forward
    after = np.stack([relative @ placed.right / depth, relative @ placed.up / depth, -1 / depth], axis=-1)
    sun = to_sun(90, 30)
    # The place of a point at infinity.
    lamp = np.array([sun @ placed.right, sun @ placed.up, 0.0]) / (sun @ placed.forward)
    axis = (after.min(axis=0) + after.max(axis=0)) / 2 - lamp
    beams = after - lamp
    screen = np.linalg.svd(axis[None])[2][1:]
    image = beams @ screen.T / (beams @ axis)[:, None]
    place = places(found, light, points)
    rows = [[*p, 1, 0, 0, 0, *(-q[0] * np.array([*p, 1]))] for p, q in zip(image, place, strict=True)]
    rows += [[0, 0, 0, *p, 1, *(-q[1] * np.array([*p, 1]))] for p, q in zip(image, place, strict=True)]
    values = np.linalg.svd(np.array(rows) / np.linalg.norm(rows, axis=1)[:, None])[1]
    assert values[-1] < 1e-6 * values[-2]


def test_a_slide_makes_texels_more_even() -> None:
    def spread(slide: float) -> float:
        found, light = made(90, 30, slide=slide)
        place = places(found, light, np.array([[0, 0, 0], [0, 100, 0], [0, 1200, 0], [0, 1300, 0]], float))
        return float(np.linalg.norm(place[1] - place[0]) / np.linalg.norm(place[3] - place[2]))

    assert spread(0) > 3 * spread(500) > 3
    assert spread(100000) == pytest.approx(1, abs=0.1)


def test_a_sun_behind_the_eye_slides_it_back() -> None:
    assert made(90, 30)[0].slide == 0
    assert made(165, 10)[0].slide > 0


def test_a_parallel_view_gets_the_plain_map() -> None:
    found, _ = made(90, 30, Orthographic(width=500))
    np.testing.assert_allclose(found.to_map[2], [0, 0, 1])
    np.testing.assert_allclose(found.to_map[[0, 1], [1, 0]], 0)
