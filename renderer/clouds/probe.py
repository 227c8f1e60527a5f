"""What lies at a point of the clouds' picture: place, height, clouds overhead, and the sun there."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.clouds.cloud_map import thickness_map
from renderer.clouds.frame_values import cloud_side, drift
from renderer.clouds.world_scale import LAND_CELL
from renderer.core.technique import Arrays
from renderer.world.camera import rays
from renderer.world.sun import direction

if TYPE_CHECKING:
    from renderer.clouds.state import CloudsState


def probe(
    state: CloudsState, arrays: Mapping[str, Arrays], x: float, y: float, size: tuple[int, int]
) -> dict[str, Any]:
    """Facts about what a ray meets first of ground and clouds' base, angles in degrees.

    Args:
        arrays: of the bakes, by name. x, y: place in the picture, in [0, 1], row 0 at the top. size: (width, height).

    Returns:
        `position` east, north and above the sphere [m]; `optical_depth` of the layer there, along the vertical;
        `sun_elevation` there; or `sky` where neither is met.
    """
    width, height = size
    column, row = min(int(x * width), width - 1), min(int(y * height), height - 1)
    origins, directions = rays(state.camera, width, height, (x * width - column, y * height - row))
    centre = np.array([0.0, 0.0, -state.planet.radius])
    origin, ray = origins[row, column] - centre, directions[row, column]
    met = [t for t in (_meets(origin, ray, state.planet.radius + h) for h in (0.0, state.layer.base)) if t is not None]
    if not met:
        return {"sky": True}
    point = origin + min(met) * ray
    up = point / np.linalg.norm(point)
    place = stereographic(point, state.planet.radius)
    ground = _bilinear(arrays["land"]["height"], place / LAND_CELL, False)
    elevation = max(float(np.linalg.norm(point)) - state.planet.radius, ground)
    at = (place - np.array(drift(state))) / cloud_side(state)
    cover = thickness_map(state.clouds, arrays["fields"], state.time)
    repeats = state.clouds.kind != "asset" or state.clouds.repeats
    share = _bilinear(cover, at * cover.shape[0], repeats)
    return {
        "position": [round(float(place[0]), 1), round(float(place[1]), 1), round(elevation, 1)],
        "optical_depth": round(max(share, 0.0) * state.layer.thickness * state.layer.extinction, 3),
        "sun_elevation": round(math.degrees(math.asin(float(np.clip(up @ direction(state.sun), -1, 1)))), 2),
    }


def stereographic(point: np.ndarray, radius: float) -> np.ndarray:
    """Place (2,) [m] on the maps of a point (3,) from the planet's centre [m]: the twin of `place_of`."""
    found: np.ndarray = point[:2] * 2 * radius / (np.linalg.norm(point) + point[2])
    return found


def _meets(origin: np.ndarray, ray: np.ndarray, radius: float) -> float | None:
    """Distance ahead to a sphere round the centre, or None."""
    along, square = float(origin @ ray), float(origin @ origin) - radius**2
    depth = along**2 - square
    ahead = [t for t in (-along - math.sqrt(max(depth, 0.0)), -along + math.sqrt(max(depth, 0.0))) if t > 0]
    return ahead[0] if depth > 0 and ahead else None


def _bilinear(grid: np.ndarray, at: np.ndarray, repeats: bool) -> float:
    """Value of a map round its centre, `at` in texels from there; zero outside where it does not repeat."""
    size = grid.shape[0]
    if not repeats and np.abs(at).max() > size / 2:
        return 0.0
    x, y = at + size / 2 - 0.5
    left, low = math.floor(x), math.floor(y)
    u, v = x - left, y - low
    near = [[float(grid[(low + j) % size, (left + i) % size]) for i in (0, 1)] for j in (0, 1)]
    return (near[0][0] * (1 - u) + near[0][1] * u) * (1 - v) + (near[1][0] * (1 - u) + near[1][1] * u) * v
