"""What lies at a point of the forest's picture: place, slope, stand, horizon, and the day's sun."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, REACH
from renderer.world.camera import rays
from renderer.world.sun import SunMoment, angles, day
from renderer.world.terrain import height_at, normal_at

if TYPE_CHECKING:
    from renderer.forest.state import ForestState

AZIMUTHS = 72
"""Directions of the horizon that a probe draws: every five degrees."""


def probe(
    state: ForestState, arrays: Mapping[str, Arrays], x: float, y: float, size: tuple[int, int]
) -> dict[str, Any]:
    """Facts about the ground under a point of the picture, angles in degrees.

    Args:
        arrays: of the bakes, by name. x, y: place in the picture, in [0, 1], row 0 at the top. size: (width, height).

    Returns:
        `position` east, north and above the square's lowest point [m], `elevation` above the sea [m], `slope`,
        `wooded`, `horizon` and its `azimuths`, seen from `eye_height` above the ground [m]: the ground itself, or the
        treetops where there is a stand; whether the `sun_up` there, and its `sun_hours` where the sun is a moment's;
        or `sky` where nothing is met.
    """
    ground = arrays["terrain"]
    origin, direction = _ray(state, x, y, size)
    place = _ground_under(ground["elevation"], origin, direction)
    if place is None:
        return {"sky": True}
    cells = (CELL, CELL)
    normal = normal_at(ground["elevation"], cells, place[0], place[1])
    eye = eye_above(ground["surface"], place)
    elevations, azimuths = horizon(ground["surface"], eye)
    facts = {
        "position": [round(float(value), 2) for value in place],
        "elevation": round(float(place[2] + ground["base"]), 2),
        "slope": round(math.degrees(math.acos(min(1.0, float(normal[2])))), 2),
        "wooded": bool(height_at(ground["cover"], cells, place[0], place[1]) > 0.5),
        "eye_height": round(float(eye[2] - place[2]), 2),
        "horizon": [round(math.degrees(value), 2) for value in elevations],
        "azimuths": [round(math.degrees(value), 2) for value in azimuths],
        "sun_up": bool(angles(state.sun)[1] > np.interp(angles(state.sun)[0] % (2 * math.pi), azimuths, elevations)),
    }
    if isinstance(state.sun, SunMoment):
        path = day(state.sun)
        limit = np.interp(path.azimuth % (2 * math.pi), azimuths, elevations, period=2 * math.pi)
        facts["sun_hours"] = round(
            float(np.mean(path.elevation > limit) * (path.seconds[-1] - path.seconds[0]) / 3600), 2
        )
    return facts


def eye_above(surface: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Where one looks round from at a place (3,) of the ground [m]: from the treetops, if a stand is above it."""
    return np.array([*place[:2], max(float(place[2]), float(height_at(surface, (CELL, CELL), place[0], place[1])))])


def horizon(surface: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Elevation of the horizon [rad] around a point of the ground, and its azimuths [rad] clockwise from north.

    Args:
        surface: (N, N) height of land and stands [m]. place: (3,) [m], of the eye.
    """
    azimuths = np.arange(AZIMUTHS) * 2 * math.pi / AZIMUTHS
    distance = np.geomspace(CELL / 2, CELL * surface.shape[0], 240)
    east = place[0] + np.sin(azimuths)[:, None] * distance
    north = place[1] + np.cos(azimuths)[:, None] * distance
    rise = height_at(surface, (CELL, CELL), east, north) - place[2]
    return np.maximum(np.arctan2(rise, distance).max(axis=1), 0.0), azimuths


def _ray(state: ForestState, x: float, y: float, size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Origin and direction of the ray through a place of the picture."""
    width, height = size
    column, row = min(int(x * width), width - 1), min(int(y * height), height - 1)
    origins, directions = rays(state.camera, width, height, (x * width - column, y * height - row))
    return origins[row, column], directions[row, column]


def _ground_under(elevation: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> np.ndarray | None:
    """Where a ray first meets the ground, or None."""
    top = float(elevation.max()) + CANOPY_HEIGHT
    start = max(0.0, (top - origin[2]) / direction[2]) if direction[2] < 0 else 0.0
    if direction[2] >= 0 and origin[2] > top:
        return None
    t = start + np.concatenate([[0.0], np.geomspace(0.5, REACH, 4000)])
    above = _clearance(elevation, origin, direction, t)
    below = np.flatnonzero(above <= 0)
    if not len(below):
        return None
    low, high = t[max(below[0] - 1, 0)], t[below[0]]
    for _ in range(24):
        middle = (low + high) / 2
        low, high = (
            (middle, high) if _clearance(elevation, origin, direction, np.array([middle]))[0] > 0 else (low, middle)
        )
    place: np.ndarray = origin + high * direction
    return place


def _clearance(elevation: np.ndarray, origin: np.ndarray, direction: np.ndarray, t: np.ndarray) -> np.ndarray:
    points = origin + t[:, None] * direction
    height: np.ndarray = points[:, 2] - height_at(elevation, (CELL, CELL), points[:, 0], points[:, 1])
    return height
