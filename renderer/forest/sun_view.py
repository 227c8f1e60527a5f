"""The parallel view from the sun that covers what the camera sees: where a depth shadow map is drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.core.technique import Arrays
from renderer.world.camera import Camera, rays

PROBES = 24
"""Rays a side by which the visible ground is found."""


@dataclass(frozen=True)
class SunView:
    """A square window facing the sun.

    Attributes:
        corner: world position [m] of texel coordinate (0, 0), beyond all that could cast a shadow into the window.
        right, up: world vectors [m] from that corner along the window's sides.
        size: side of the window [m].
    """

    corner: np.ndarray
    right: np.ndarray
    up: np.ndarray
    size: float


def visible_points(
    camera: Camera, ground: Arrays, cell: float, canopy_height: float, reach: float, size: tuple[int, int]
) -> np.ndarray:
    """Points (P, 3) of canopy top and ground that a grid of the camera's rays meets.

    Args:
        ground: the `terrain` bake. cell: its cell [m]. canopy_height, reach: [m]. size: (width, height) of the picture.
    """
    width = PROBES
    height = max(2, round(PROBES * size[1] / size[0]))
    origins, directions = (a.reshape(-1, 3) for a in rays(camera, width, height))
    elevation = ground["elevation"]
    nodes = elevation.shape[0]
    top = float(elevation.max()) + canopy_height
    distance = np.geomspace(1.0, reach, 160)
    start = np.where(origins[:, 2] > top, (top - origins[:, 2]) / np.minimum(directions[:, 2], -1e-6), 0.0)
    points = origins[:, None, :] + directions[:, None, :] * (start[:, None] + distance)[..., None]
    column = np.clip(np.rint(points[..., 0] / cell + (nodes - 1) / 2), 0, nodes - 1).astype(int)
    row = np.clip(np.rint((nodes - 1) / 2 - points[..., 1] / cell), 0, nodes - 1).astype(int)
    above = points[..., 2] - elevation[row, column]
    found = []
    for level in (canopy_height, 0.0):
        below = above <= level
        hit = below.argmax(axis=1)
        found.append(points[np.arange(len(points)), hit][below.any(axis=1)])
    return np.concatenate(found)


def fit(points: np.ndarray, sun: np.ndarray, ground: Arrays, cell: float, canopy_height: float) -> SunView:
    """The smallest square window facing the sun that holds `points`, or the whole terrain where there are none.

    Args:
        points: (P, 3) [m]. sun: unit vector to the sun. ground, cell, canopy_height: as in `visible_points`.
    """
    elevation = ground["elevation"]
    half = (elevation.shape[0] - 1) / 2 * cell
    top = float(elevation.max()) + canopy_height
    if len(points) == 0:
        points = np.array([[x, y, z] for x in (-half, half) for y in (-half, half) for z in (0.0, top)])
    side = np.cross((0.0, 0.0, 1.0), sun)
    right = side / np.linalg.norm(side) if np.linalg.norm(side) > 1e-6 else np.array([1.0, 0.0, 0.0])
    up = np.cross(sun, right)
    low = np.array([(points @ axis).min() for axis in (right, up)])
    high = np.array([(points @ axis).max() for axis in (right, up)])
    size = float((high - low).max()) * 1.02 + canopy_height
    centre = (low + high) / 2
    away = max(top / max(sun[2], 0.02), float((points @ sun).max()) + 2 * half)
    corner = right * (centre[0] - size / 2) + up * (centre[1] - size / 2) + sun * away
    return SunView(corner, right * size, up * size, size)
