"""Cameras: closed forms of a few rays, limits, and refusals in words."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from renderer.core.errors import InvalidDocument, LimitError
from renderer.core.params import validate
from renderer.gl.probe import probe
from renderer.gl.thread import GLThread
from renderer.world.camera import CAMERA_DECLARATIONS, RETREAT, Look, Orbit, Orthographic, camera_uniforms, pose, rays
from renderer.world.state import SceneState

CAMERAS = [
    Orbit(target=(10.0, -20.0, 5.0), distance=300.0, azimuth=210.0, elevation=35.0, field_of_view=50.0),
    Look(eye=(1.0, 2.0, 3.0), target=(-40.0, 7.0, 1.0), up=(0.1, 0.0, 1.0), field_of_view=70.0),
    Orthographic(centre=(5.0, 6.0, 7.0), direction=(1.0, 2.0, -2.0), up=(0.0, 0.0, 1.0), width=80.0),
]


@pytest.mark.parametrize(
    ("azimuth", "eye"),
    [(0.0, (0, 100, 0)), (90.0, (100, 0, 0)), (180.0, (0, -100, 0)), (270.0, (-100, 0, 0))],
)
def test_an_orbit_stands_where_its_azimuth_says(azimuth: float, eye: tuple[float, ...]) -> None:
    """Clockwise from north, seen from the target; the picture's up stays z."""
    found = pose(Orbit(distance=100.0, azimuth=azimuth, elevation=0.0))
    np.testing.assert_allclose(found.eye, eye, atol=1e-12)
    np.testing.assert_allclose(found.forward, -np.asarray(eye) / 100.0, atol=1e-15)
    np.testing.assert_allclose(found.up, (0, 0, 1), atol=1e-15)


def test_from_the_south_east_is_right_and_row_0_is_above() -> None:
    """A camera south of its target that looks north sees east on the right and the sky in row 0."""
    _, directions = rays(Orbit(azimuth=180.0, elevation=0.0), 5, 5)
    assert directions[2, 4, 0] > 0 > directions[2, 0, 0]
    assert directions[0, 2, 2] > 0 > directions[4, 2, 2]
    np.testing.assert_allclose(directions[2, 2], (0, 1, 0), atol=1e-15)


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda c: c.kind)
def test_frames_are_right_handed(camera: Any) -> None:
    """Right, up and backward form a rotation, so nothing is mirrored."""
    p = pose(camera)
    axes = np.stack([p.right, p.up, -p.forward])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-14)
    np.testing.assert_allclose(np.cross(p.right, p.up), -p.forward, atol=1e-14)


def test_field_of_view_is_vertical_and_pixels_are_square() -> None:
    """Rays through top and bottom edges enclose the field of view, whatever the width; pixel centres lie at halves."""
    camera = Look(eye=(0, 0, 0), target=(0, 1, 0), field_of_view=60.0)
    for width in (8, 32):
        _, top = rays(camera, width, 16, offset=(0.5, 0.0))
        np.testing.assert_allclose(top[0, :, 2] / top[0, :, 1], math.tan(math.radians(30.0)), rtol=1e-12)
        _, centre = rays(camera, width, 16)
        slopes = centre[..., 2] / centre[..., 1]
        expected = math.tan(math.radians(30.0)) * (1.0 - (np.arange(16) + 0.5) / 8.0)
        np.testing.assert_allclose(slopes[:, 0], expected, rtol=1e-12)
        across = centre[0, :, 0] / centre[0, :, 1]
        np.testing.assert_allclose(np.diff(across), -np.diff(slopes[:, 0])[0], rtol=1e-9)
        np.testing.assert_allclose(across, -across[::-1], atol=1e-14)


def test_orthographic_rays_are_a_map() -> None:
    """From above with up = north: column = east, row = south, one pixel = width / columns, nothing in front is cut."""
    camera = Orthographic(centre=(100.0, 200.0, 50.0), direction=(0, 0, -1), up=(0, 1, 0), width=40.0)
    origins, directions = rays(camera, 4, 2)
    np.testing.assert_allclose(directions, np.broadcast_to((0.0, 0.0, -1.0), directions.shape))
    np.testing.assert_allclose(origins[0, :, 0], [85, 95, 105, 115])
    np.testing.assert_allclose(origins[:, 0, 1], [205, 195])
    np.testing.assert_allclose(origins[..., 2], 50.0 + RETREAT * 40.0)


def test_an_orbit_passes_its_pole_without_a_jump() -> None:
    """At elevation 90 the picture is the limit of what comes before, with the azimuth's direction down."""
    limit = rays(Orbit(azimuth=30.0, elevation=90.0 - 1e-7), 6, 4)[1]
    pole = rays(Orbit(azimuth=30.0, elevation=90.0), 6, 4)[1]
    np.testing.assert_allclose(pole, limit, atol=1e-8)
    np.testing.assert_allclose(pose(Orbit(azimuth=30.0, elevation=90.0)).up, [-0.5, -math.sqrt(0.75), 0], atol=1e-12)


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda c: c.kind)
def test_uniforms_give_the_rays_in_float32(camera: Any) -> None:
    """What the shader evaluates, in float32, lies within its rounding of the float64 rays: 1e-6 of a radian."""
    u = {k: np.float32(v) for k, v in camera_uniforms(camera, 33, 17).items()}
    x, y = np.float32(20.25), np.float32(3.75)
    direction = u["camera_corner"] + x * u["camera_dx"] + y * u["camera_dy"]
    origin = u["camera_origin"] + x * u["camera_origin_dx"] + y * u["camera_origin_dy"]
    origins, directions = rays(camera, 33, 17, offset=(0.25, 0.75))
    np.testing.assert_allclose(direction / np.linalg.norm(direction), directions[3, 20], atol=1e-6)
    np.testing.assert_allclose(origin, origins[3, 20], rtol=1e-5)


@pytest.fixture(scope="module")
def gl() -> Iterator[GLThread]:
    """A context of this module's own."""
    with GLThread() as thread:
        yield thread


@pytest.mark.parametrize("camera", CAMERAS, ids=lambda c: c.kind)
def test_glsl_agrees_with_the_twin(camera: Any, gl: GLThread) -> None:
    """Every ray to 1e-6 of a radian and of its origin's size; the same measure rejects a picture turned over."""
    width, height = 9, 7
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    body = "vec3 o, d; camera_ray(pixel, o, d); result = float[6](o.x, o.y, o.z, d.x, d.y, d.z);"

    def run(rows: np.ndarray) -> np.ndarray:
        pixels = np.stack([x.ravel(), rows.ravel()], axis=1).astype(np.float32)
        uniforms = camera_uniforms(camera, width, height)
        return np.asarray(
            gl.call(
                lambda on: probe(
                    on,
                    ["lib/camera.glsl"],
                    body,
                    {"pixel": pixels},
                    6,
                    declarations=CAMERA_DECLARATIONS,
                    uniforms=uniforms,
                )
            )
        )

    origins, directions = (a.reshape(-1, 3) for a in rays(camera, width, height))
    found = run(y)
    np.testing.assert_allclose(found[:, :3], origins, atol=1e-6 * np.abs(origins).max())
    np.testing.assert_allclose(found[:, 3:], directions, atol=1e-6)
    turned = run(height - y)
    assert max(np.abs(turned[:, :3] - origins).max(), np.abs(turned[:, 3:] - directions).max()) > 0.1


@pytest.mark.parametrize(
    ("document", "field"),
    [
        ({"kind": "look", "eye": [1, 2, 3], "target": [1, 2, 3]}, "camera.target"),
        ({"kind": "look", "eye": [0, 0, 9], "target": [0, 0, 0]}, "camera.up"),
        ({"kind": "look", "up": [0, 0, 0]}, "camera.up"),
        ({"kind": "look", "eye": [float("nan"), 0, 0]}, "camera.eye.0"),
        ({"kind": "orthographic", "direction": [0, 0, 0]}, "camera.direction"),
        ({"kind": "orthographic", "direction": [0, 2, 0]}, "camera.up"),
        ({"kind": "orthographic", "width": 0}, "camera.width"),
        ({"kind": "orbit", "distance": float("inf")}, "camera.distance"),
        ({"kind": "orbit", "elevation": 91}, "camera.elevation"),
        ({"kind": "orbit", "field_of_view": 180}, "camera.field_of_view"),
        ({"kind": "orbit", "target": [1e30, 0, 0]}, "camera.target"),
        ({"kind": "orbit", "target": [0, 0]}, "camera.target.2"),
        ({"kind": "fisheye"}, "camera.kind"),
        ({"kind": "orbit", "roll": 3}, "camera.roll"),
    ],
)
def test_a_camera_that_cannot_be_is_refused_by_name(document: dict[str, Any], field: str) -> None:
    """The first error names the field; none of them is a stack trace."""
    with pytest.raises(InvalidDocument) as refused:
        validate(SceneState, {"camera": document})
    assert refused.value.errors[0].field == field
    assert "Value error" not in str(refused.value)


@pytest.mark.parametrize(("width", "height", "field"), [(0, 5, "width"), (5, -1, "height"), (1 << 17, 5, "width")])
def test_picture_sizes_are_bounded(width: int, height: int, field: str) -> None:
    """A size without pixels, or with too many, is refused before anything is allocated."""
    with pytest.raises(LimitError) as refused:
        rays(Orbit(), width, height)
    assert refused.value.field == field
