"""Pictures of all directions: their texels' directions and solid angles, other sizes, and the built-in ones."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy import ndimage

ROWS = 256
"""Of a picture on the GPU: 0.7 degrees a texel."""


def directions(rows: int, columns: int) -> np.ndarray:
    """(rows, columns, 3) unit vectors of the texels' middles, x east, y the picture's north, z up."""
    polar, azimuth = (np.arange(rows) + 0.5) / rows * math.pi, (np.arange(columns) + 0.5) / columns * 2 * math.pi
    level = np.sin(polar)[:, None]
    parts = np.broadcast_arrays(level * np.sin(azimuth), level * np.cos(azimuth), np.cos(polar)[:, None])
    return np.stack(parts, axis=-1)


def solid_angles(rows: int, columns: int) -> np.ndarray:
    """(rows, columns) [sr]."""
    edges = np.cos(np.linspace(0, math.pi, rows + 1))
    return np.repeat((edges[:-1] - edges[1:])[:, None] * (2 * math.pi / columns), columns, axis=1)


def fewer(image: np.ndarray, rows: int) -> np.ndarray:
    """A picture with fewer rows, of which its own are a multiple: means by solid angle."""
    block = len(image) // rows
    solid = solid_angles(*image.shape[:2])[..., None]
    shape = (rows, block, image.shape[1] // block, block, -1)
    light, weight = ((part.reshape(shape)).sum(axis=(1, 3)) for part in (image * solid, solid))
    return np.asarray(light / weight)


def resampled(picture: np.ndarray, rows: int) -> np.ndarray:
    """A picture (height, width, 3) with `rows` rows and twice as many columns, its light kept where it has more."""
    height, width = picture.shape[:2]
    finer = max(1, round(height / rows))
    side = rows * finer
    down = (np.arange(side) + 0.5) / side * height - 0.5
    across = (np.arange(2 * side) + 0.5) / (2 * side) * width - 0.5
    wide = np.concatenate([picture[:, -1:], picture, picture[:, :1]], axis=1)
    grid = np.meshgrid(down, across + 1, indexing="ij")
    same = (height, width) == (side, 2 * side)
    stretched = picture if same else np.stack(
        [ndimage.map_coordinates(wide[..., channel], grid, order=1, mode="nearest") for channel in range(3)], axis=-1
    )
    return fewer(stretched, rows)


def _soft(distance: np.ndarray, edge: float) -> np.ndarray:
    """1 inside, 0 outside by `edge` beyond, smooth between."""
    t = np.clip(1 - distance / edge, 0, 1)
    return t * t * (3 - 2 * t)


def _panel(ways: np.ndarray, azimuth: float, elevation: float, width: float, height: float) -> np.ndarray:
    """How much of a soft rectangle of light is in each direction: angles in degrees, of its middle and half sides."""
    a, e = math.radians(azimuth), math.radians(elevation)
    middle = np.array([math.cos(e) * math.sin(a), math.cos(e) * math.cos(a), math.sin(e)])
    right = np.array([math.cos(a), -math.sin(a), 0.0])
    up = np.cross(right, middle)
    before = np.maximum(ways @ middle, 1e-3)
    u, v = np.abs(ways @ right / before), np.abs(ways @ up / before)
    off = np.maximum(u - math.tan(math.radians(width)), v - math.tan(math.radians(height)))
    return np.asarray(np.where(ways @ middle > 0, _soft(np.maximum(off, 0), 0.12), 0.0)[..., None])


def studio() -> np.ndarray:
    """A dim room: a broad warm light high at one side, a cool strip opposite, a narrow one behind, a pale floor."""
    ways = directions(ROWS, 2 * ROWS)
    height = ways[..., 2:]
    room = 0.10 + 0.08 * np.maximum(height, 0)
    floor = 0.22 * np.exp(-3 * np.abs(height + 0.75)) + 0.05
    picture = np.where(height < 0, floor + (room - floor) * np.exp(height * 12), room) * [1.0, 0.97, 0.93]
    for place, brightness, colour in (
        ((130, 48, 26, 18), 5.0, (1.0, 0.93, 0.82)),
        ((262, 22, 7, 34), 3.0, (0.72, 0.87, 1.0)),
        ((20, 30, 26, 5), 2.5, (1.0, 0.98, 0.95)),
    ):
        picture = picture + _panel(ways, *place) * (np.array(colour) * brightness)
    return np.asarray(picture)


def evening() -> np.ndarray:
    """A low sun behind haze over dark hills."""
    ways = directions(ROWS, 2 * ROWS)
    height, azimuth = ways[..., 2:], np.arctan2(ways[..., 0], ways[..., 1])[..., None]
    e, a = math.radians(9), math.radians(250)
    sun = np.array([math.cos(e) * math.sin(a), math.cos(e) * math.cos(a), math.sin(e)])
    away = np.degrees(np.arccos(np.clip(ways @ sun, -1, 1)))[..., None]
    zenith, level = np.array([0.16, 0.28, 0.62]), np.array([0.9, 0.62, 0.42])
    sky = zenith + (level - zenith) * np.exp(-np.maximum(height, 0) * 5)
    sky = sky + np.array([1.6, 0.8, 0.3]) * np.exp(-away / 22) + np.array([180.0, 110.0, 55.0]) * _soft(away - 1.6, 1.4)
    ridge = 0.05 + 0.035 * np.sin(3 * azimuth + 0.4) + 0.02 * np.sin(7 * azimuth + 2.1) + 0.01 * np.sin(17 * azimuth)
    ground = np.array([0.07, 0.06, 0.045]) * (1 + 0.8 * np.exp(-away / 60))
    haze = _soft(ridge + 0.02 - height, 0.05)  # a ridge as sharp as texels would show them
    return np.asarray(ground + haze * (sky - ground))


PICTURES: dict[str, Callable[[], np.ndarray]] = {"studio": studio, "evening": evening}
"""The built-in pictures, (ROWS, 2 ROWS, 3), 1 being a well-lit wall."""
