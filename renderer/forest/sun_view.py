"""The view from the sun that covers what the camera sees: where shadow maps are drawn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.core.technique import Arrays
from renderer.world.camera import Camera, pose, rays

PROBES = 24
"""Rays a side by which the visible ground is found."""

SIZES_PER_OCTAVE = 4
"""Sizes that a snapped window may have between one and its double: the fewer, the rarer its texels change."""


@dataclass(frozen=True)
class Light:
    """The sun's parallel light as a frame: two unit vectors across it, and where along it nothing lies any more.

    Attributes:
        right, up: (3,) unit vectors; `right` is horizontal.
        away: sunward coordinate [m] that nothing which casts a shadow exceeds.
    """

    right: np.ndarray
    up: np.ndarray
    away: float

    def across(self, points: np.ndarray) -> np.ndarray:
        """Coordinates (P, 2) of points (P, 3) along `right` and `up` [m]."""
        return points @ np.stack([self.right, self.up], axis=-1)


@dataclass(frozen=True)
class Window:
    """A rectangle across the light.

    Attributes:
        low: its corner along `right` and `up` [m].
        sides: [m].
    """

    low: tuple[float, float]
    sides: tuple[float, float]

    def texels(self, resolution: int) -> tuple[float, float, float, float]:
        """Corner and the sides of a texel [m], as shaders take it."""
        return (*self.low, self.sides[0] / resolution, self.sides[1] / resolution)


def light_of(sun: np.ndarray, ground: Arrays, cell: float, canopy_height: float) -> Light:
    """The frame of the sun's light over the whole land.

    Args:
        sun: unit vector to the sun. ground: the `terrain` bake. cell: its cell [m]. canopy_height: [m].
    """
    elevation = ground["elevation"]
    half = (elevation.shape[0] - 1) / 2 * cell
    top = float(elevation.max()) + canopy_height
    side = np.cross((0.0, 0.0, 1.0), sun)
    right = side / np.linalg.norm(side) if np.linalg.norm(side) > 1e-6 else np.array([1.0, 0.0, 0.0])
    # Half as far again as the square's own corner: what the land, drawn on beyond its edge, may still cast.
    return Light(right, np.cross(sun, right), 1.5 * float(np.hypot(half, half) * np.hypot(*sun[:2]) + top))


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


def or_whole_land(points: np.ndarray, ground: Arrays, cell: float, canopy_height: float) -> np.ndarray:
    """The points, or the corners of the land where there are none: a view of the sky alone."""
    if len(points):
        return points
    half = (ground["elevation"].shape[0] - 1) / 2 * cell
    top = float(ground["elevation"].max()) + canopy_height
    return np.array([[x, y, z] for x in (-half, half) for y in (-half, half) for z in (0.0, top)])


def fit(points: np.ndarray, light: Light, margin: float) -> Window:
    """The smallest window that holds points (P, 3), with a margin [m] and a hundredth more on each side."""
    across = light.across(points)
    low, high = across.min(axis=0), across.max(axis=0)
    room = margin + 0.01 * (high - low)
    low, sides = low - room, high - low + 2 * room
    return Window((float(low[0]), float(low[1])), (float(sides[0]), float(sides[1])))


def snapped(window: Window, resolution: int) -> Window:
    """A window at least as large whose texels lie on a grid fixed in the world, and whose size seldom changes.

    While the camera moves, each texel then looks along the same line as before (Valient 2007). One texel is lost to
    the rounding.
    """
    found = []
    for low, side in zip(window.low, window.sides, strict=True):
        step = 2.0 ** (np.ceil(SIZES_PER_OCTAVE * np.log2(side / (resolution - 1))) / SIZES_PER_OCTAVE)
        found.append((float(np.floor(low / step) * step), float(step * resolution)))
    return Window((found[0][0], found[1][0]), (found[0][1], found[1][1]))


def depths(camera: Camera, points: np.ndarray) -> np.ndarray:
    """How far points (P, 3) lie before the camera's plane [m]."""
    placed = pose(camera)
    return np.asarray((points - placed.eye) @ placed.forward)
