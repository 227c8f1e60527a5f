"""The view from the sun in the camera's post-projective space, as a map of the plane across the light.

All points of one line of the sun's light fall on one texel of any map drawn from the sun. So whatever perspective the
map is drawn in, it is a homography of the plane across the light: three by three numbers hold the two projections.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.forest.sun_view import Light, depths
from renderer.world.camera import Camera, Orthographic, pose

SLIDES = 24
"""Times that the eye is slid back, each time twice as far, before the map gives up its perspective."""

SHALLOWEST = 1e-4
"""Least share that a point's weight in the projection may have of the greatest: what lies on the projection's own
horizon would need an endless map."""

MARGIN = 0.04
"""Room round the points, as a share of the map."""


@dataclass(frozen=True)
class PerspectiveMap:
    """Where lines of light lie on a map.

    Attributes:
        anchor: (2,) place across the light [m] from which lines are counted, so that float32 keeps millimetres.
        to_map: (3, 3) from (right, up, 1) [m], after the anchor, to (x, y, w); (x, y) / w in [0, 1] is the map.
        to_light: its inverse.
        slide: how far the eye was slid back [m].
    """

    anchor: np.ndarray
    to_map: np.ndarray
    to_light: np.ndarray
    slide: float


def perspective_map(camera: Camera, points: np.ndarray, light: Light, sun: np.ndarray, slide: float) -> PerspectiveMap:
    """The map of the points (P, 3) in the space after the camera's projection.

    Args:
        camera: one with a parallel view has no such space, and gets the plain map.
        points: what the camera sees [m].
        light: the sun's light. sun: unit vector to the sun.
        slide: distance [m] by which the eye is slid back at first. It is slid farther until every point lies on the
            near side of the map's own horizon.

    Source: Stamminger & Drettakis 2002, sections 3 and 4 (the light after the projection; the eye slid back).
    """
    anchor = light.across(points).mean(axis=0)
    across = np.concatenate([light.across(points) - anchor, np.ones((len(points), 1))], axis=1)
    plain = np.eye(3)
    if isinstance(camera, Orthographic):
        return _fitted(plain, across, anchor, 0.0)
    back = slide
    for _ in range(SLIDES):
        found = _homography(camera, points, light, sun, anchor, back)
        weight = across @ found[2]
        if weight.min() > SHALLOWEST * weight.max() > 0:
            return _fitted(found, across, anchor, back)
        back = 2 * back if back > 0 else 1.0
    return _fitted(plain, across, anchor, back)


def _homography(
    camera: Camera, points: np.ndarray, light: Light, sun: np.ndarray, anchor: np.ndarray, slide: float
) -> np.ndarray:
    """Plane across the light, through the camera's projection and the light's there, to an image plane of the light."""
    seen = _projection(camera, points, slide)
    lamp = seen @ np.array([*sun, 0.0])
    projected = np.concatenate([points, np.ones((len(points), 1))], axis=1) @ seen.T
    places = projected[:, :3] / projected[:, 3:]
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    if abs(lamp[3]) > 1e-6:
        axis = middle - lamp[:3] / lamp[3]
        axis /= np.linalg.norm(axis)
        right, up = _across(axis)
        to_plane = np.stack([np.append(v, -v @ lamp[:3] / lamp[3]) for v in (right, up, axis)])
    else:  # the sun beside the camera stays at infinity
        right, up = _across(lamp[:3] / np.linalg.norm(lamp[:3]))
        to_plane = np.stack([np.append(right, 0.0), np.append(up, 0.0), [0.0, 0.0, 0.0, 1.0]])
    start = anchor[0] * light.right + anchor[1] * light.up
    line = np.stack([np.append(light.right, 0.0), np.append(light.up, 0.0), np.append(start, 1.0)], axis=1)
    return np.asarray(to_plane @ seen @ line)


def _projection(camera: Camera, points: np.ndarray, slide: float) -> np.ndarray:
    """The camera's projection (4, 4), its eye slid back, near and far planes at the nearest and farthest point."""
    placed = pose(camera)
    eye = placed.eye - slide * placed.forward
    depth = depths(camera, points) + slide
    near = max(float(depth.min()), 1e-3 * float(depth.max()))
    far = max(float(depth.max()), 1.001 * near)
    relative = points - eye
    ahead = np.maximum(depth, near)
    wide = max(float(np.abs(relative @ placed.right / ahead).max()), 1e-6)
    high = max(float(np.abs(relative @ placed.up / ahead).max()), 1e-6)
    turn = np.stack([np.append(v, -v @ eye) for v in (placed.right / wide, placed.up / high, placed.forward)])
    scale, shift = (far + near) / (far - near), -2 * far * near / (far - near)
    return np.stack([turn[0], turn[1], scale * turn[2] + np.array([0, 0, 0, shift]), turn[2]])


def _across(axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across an axis."""
    least = np.eye(3)[int(np.argmin(np.abs(axis)))]
    right = np.cross(least, axis)
    right /= np.linalg.norm(right)
    return right, np.cross(axis, right)


def _fitted(homography: np.ndarray, across: np.ndarray, anchor: np.ndarray, slide: float) -> PerspectiveMap:
    """The homography with all points, and a margin, inside the unit square."""
    places = across @ homography.T
    flat = places[:, :2] / places[:, 2:]
    low, high = flat.min(axis=0), flat.max(axis=0)
    room = np.maximum(high - low, 1e-9) * MARGIN
    low, sides = low - room, high - low + 2 * room
    to_unit = np.array([[1 / sides[0], 0, -low[0] / sides[0]], [0, 1 / sides[1], -low[1] / sides[1]], [0, 0, 1.0]])
    to_map = to_unit @ homography
    to_map /= np.abs(to_map[2]).max() * np.sign(places[0, 2])
    return PerspectiveMap(anchor, to_map, np.linalg.inv(to_map), slide)
