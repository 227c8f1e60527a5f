"""Cameras: the union every state document carries, and the rays it means.

Row 0 of a picture is its top; the centre of pixel (column i, row j) is the point (i + 0.5, j + 0.5), in pixels from the
top-left corner. A ray is the same affine function of that point in `rays` (float64) and in `shaders/lib/camera.glsl`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from renderer.core.errors import LimitError
from renderer.core.params import Model, Vector3, param

Vector = NDArray[np.float64]

FARTHEST = 1e8
"""Largest coordinate of a camera, in metres: sixteen radii of the Earth, where float32 still holds 8 m."""

PARALLEL = 1e-6
"""Sine of the angle below which two directions count as parallel: ten times the rounding of float32."""

RETREAT = 10.0
"""An orthographic camera has no eye: its rays start this many widths before the plane through its centre, so that what
stands in front of that plane is seen too. Ten widths keep a 4 km view to 4 mm in float32."""

WIDEST = 1 << 16
"""Largest width or height of a picture, in pixels, that `rays` and `camera_uniforms` accept."""

CAMERA_DECLARATIONS = """uniform vec3 camera_origin;    // m
uniform vec3 camera_origin_dx; // m per pixel
uniform vec3 camera_origin_dy; // m per pixel
uniform vec3 camera_corner;    // direction of the top-left corner, not normalised
uniform vec3 camera_dx;        // its change per pixel to the right
uniform vec3 camera_dy;        // its change per pixel downwards"""
"""The uniforms that `shaders/lib/camera.glsl` reads and `camera_uniforms` gives."""


def _within_reach(point: Vector3) -> Vector3:
    if max(abs(c) for c in point) > FARTHEST:
        raise PydanticCustomError("reach", f"lies too far away; coordinates are at most {FARTHEST:g} m")
    return point


def _direction(vector: Vector3) -> Vector3:
    if not 1e-12 < math.hypot(*vector) < 1e12:
        raise PydanticCustomError("direction", "must be a direction: a vector of finite length other than zero")
    return vector


class Orbit(Model):
    """A camera that circles a target."""

    kind: Literal["orbit"] = "orbit"
    target: Vector3 = param((0.0, 0.0, 0.0), label="Target", help="Point the camera looks at.", unit="m")
    distance: float = param(
        1000.0, label="Distance", help="Distance of the camera from its target.", unit="m", gt=0, le=FARTHEST
    )
    azimuth: float = param(
        180.0,
        label="Azimuth",
        help="Where the camera stands seen from its target, from north by east.",
        unit="deg",
        ge=-360,
        le=360,
    )
    elevation: float = param(
        30.0, label="Elevation", help="Height of the camera above the target's horizon.", unit="deg", ge=-90, le=90
    )
    field_of_view: float = param(
        40.0, label="Field of view", help="Vertical angle of the picture.", unit="deg", ge=0.1, le=170
    )

    _reach = field_validator("target")(_within_reach)


class Look(Model):
    """A camera placed freely: it flies."""

    kind: Literal["look"] = "look"
    eye: Vector3 = param((0.0, -1000.0, 500.0), label="Eye", help="Where the camera stands.", unit="m")
    target: Vector3 = param((0.0, 0.0, 0.0), label="Target", help="Point in the middle of the picture.", unit="m")
    up: Vector3 = param((0.0, 0.0, 1.0), label="Up", help="Direction that points up in the picture.")
    field_of_view: float = param(
        40.0, label="Field of view", help="Vertical angle of the picture.", unit="deg", ge=0.1, le=170
    )

    _reach = field_validator("eye", "target")(_within_reach)

    @field_validator("target")
    @classmethod
    def _apart(cls, target: Vector3, info: ValidationInfo) -> Vector3:
        eye = info.data.get("eye")
        if eye is not None and math.dist(eye, target) <= 1e-9 * max(1.0, *map(abs, eye)):
            raise PydanticCustomError("apart", "must not be the eye itself")
        return target

    @field_validator("up")
    @classmethod
    def _upright(cls, up: Vector3, info: ValidationInfo) -> Vector3:
        _direction(up)
        eye, target = info.data.get("eye"), info.data.get("target")
        if eye is not None and target is not None:
            _crosswise(np.subtract(target, eye), up)
        return up


class Orthographic(Model):
    """A parallel projection, as a map or an elevation drawing."""

    kind: Literal["orthographic"] = "orthographic"
    centre: Vector3 = param((0.0, 0.0, 0.0), label="Centre", help="Point in the middle of the picture.", unit="m")
    direction: Vector3 = param((0.0, 0.0, -1.0), label="Direction", help="Where the camera looks.")
    up: Vector3 = param((0.0, 1.0, 0.0), label="Up", help="Direction that points up in the picture.")
    width: float = param(1000.0, label="Width", help="Width of the picture on the ground.", unit="m", gt=0, le=FARTHEST)

    _reach = field_validator("centre")(_within_reach)
    _looks = field_validator("direction")(_direction)

    @field_validator("up")
    @classmethod
    def _upright(cls, up: Vector3, info: ValidationInfo) -> Vector3:
        _direction(up)
        if info.data.get("direction") is not None:
            _crosswise(info.data["direction"], up)
        return up


Camera = Annotated[Orbit | Look | Orthographic, Field(discriminator="kind")]


def _crosswise(forward: Any, up: Any) -> None:
    if float(np.linalg.norm(np.cross(_unit(forward), _unit(up)))) < PARALLEL:
        raise PydanticCustomError("up", "must not be parallel to the direction of view")


@dataclass(frozen=True)
class Pose:
    """Where a camera stands (`eye`, m) and how it is turned: unit `forward`, `right` and `up`, (3,) each."""

    eye: Vector
    forward: Vector
    right: Vector
    up: Vector


def _unit(vector: Any) -> Vector:
    array = np.asarray(vector, dtype=np.float64)
    return array / np.linalg.norm(array)


def _cross(one: Vector, other: Vector) -> Vector:
    """Of two vectors; numpy's own is made for many, and takes twenty times as long."""
    (a, b, c), (d, e, f) = one.tolist(), other.tolist()
    return np.array([b * f - c * e, c * d - a * f, a * e - b * d])


def pose(camera: Orbit | Look | Orthographic) -> Pose:
    """Position and axes of a camera, in world coordinates.

    Above its pole an orbiting camera keeps the limit of the views that lead there: its right-hand axis follows from the
    azimuth alone.
    """
    if isinstance(camera, Orbit):
        azimuth, elevation = math.radians(camera.azimuth), math.radians(camera.elevation)
        flat = math.cos(elevation)
        outward = np.array([math.sin(azimuth) * flat, math.cos(azimuth) * flat, math.sin(elevation)])
        right = np.array([-math.cos(azimuth), math.sin(azimuth), 0.0])
        return Pose(np.asarray(camera.target) + camera.distance * outward, -outward, right, _cross(right, -outward))
    if isinstance(camera, Look):
        eye = np.asarray(camera.eye, dtype=np.float64)
        forward = _unit(np.asarray(camera.target) - eye)
    else:
        forward = _unit(camera.direction)
        eye = np.asarray(camera.centre) - RETREAT * camera.width * forward
    right = _unit(_cross(forward, _unit(camera.up)))
    return Pose(eye, forward, right, _cross(right, forward))


def camera_uniforms(
    camera: Orbit | Look | Orthographic, width: int, height: int
) -> dict[str, tuple[float, float, float]]:
    """Values of `CAMERA_DECLARATIONS` for a picture of `width` x `height` pixels.

    The ray through the point p (pixels from the top-left corner) starts at
    `camera_origin + p.x camera_origin_dx + p.y camera_origin_dy` and runs along
    `normalize(camera_corner + p.x camera_dx + p.y camera_dy)`.

    Raises:
        LimitError: a width or height below 1 or above 65536.
    """
    for name, size in (("width", width), ("height", height)):
        if not 1 <= size <= WIDEST:
            raise LimitError(name, "the picture cannot have this size", f"1 to {WIDEST} px")
    p = pose(camera)
    still = np.zeros(3)
    if isinstance(camera, Orthographic):
        pixel = camera.width / width
        corner = p.eye + pixel * (-0.5 * width * p.right + 0.5 * height * p.up)
        values = (corner, pixel * p.right, -pixel * p.up, p.forward, still, still)
    else:
        pixel = 2.0 * math.tan(0.5 * math.radians(camera.field_of_view)) / height
        corner = p.forward + pixel * (-0.5 * width * p.right + 0.5 * height * p.up)
        values = (p.eye, still, still, corner, pixel * p.right, -pixel * p.up)
    names = ("camera_origin", "camera_origin_dx", "camera_origin_dy", "camera_corner", "camera_dx", "camera_dy")
    return {name: (float(v[0]), float(v[1]), float(v[2])) for name, v in zip(names, values, strict=True)}


def rays(
    camera: Orbit | Look | Orthographic, width: int, height: int, offset: tuple[float, float] = (0.5, 0.5)
) -> tuple[Vector, Vector]:
    """Rays of every pixel of a picture.

    Args:
        camera: any camera.
        width, height: pixels.
        offset: the point of each pixel the ray goes through, from its top-left corner; (0.5, 0.5) is its centre.

    Returns:
        origins (height, width, 3) in metres and unit directions (height, width, 3), row 0 at the top.

    Raises:
        LimitError: a width or height below 1 or above 65536.
    """
    u = {name: np.asarray(value) for name, value in camera_uniforms(camera, width, height).items()}
    x = (np.arange(width, dtype=np.float64) + offset[0])[None, :, None]
    y = (np.arange(height, dtype=np.float64) + offset[1])[:, None, None]
    origins = u["camera_origin"] + x * u["camera_origin_dx"] + y * u["camera_origin_dy"]
    directions = u["camera_corner"] + x * u["camera_dx"] + y * u["camera_dy"]
    return origins, directions / np.linalg.norm(directions, axis=-1, keepdims=True)
