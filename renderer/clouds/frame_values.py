"""A frame's uniforms: planet, layer, sun, the camera's place in the air, and what of its case is compiled in."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.clouds.cloud_map import highest
from renderer.clouds.program import Variant
from renderer.clouds.world_scale import AIR_TOP, LAND_CELL
from renderer.core.params import uniforms
from renderer.core.technique import Arrays
from renderer.world.camera import Orthographic
from renderer.world.sky import SOLAR_CONSTANT
from renderer.world.sun import ANGULAR_RADIUS, direction

if TYPE_CHECKING:
    from renderer.clouds.state import CloudsState

LOW_SUN = math.radians(12.0)
"""Elevation at the camera's place below which a sun may have set for what the camera sees from within the air."""


def world_values(state: CloudsState, baked: Mapping[str, Arrays]) -> dict[str, Any]:
    """Uniforms of the planet, its layer and the sun."""
    return {
        **uniforms(state.layer, "layer"),
        **uniforms(state.planet, "planet"),
        **globe_axes(state.planet.latitude, state.planet.longitude),
        "air_haze": state.air.haze,
        "land_cell": LAND_CELL,
        "land_top": float(baked["land"]["top"]),
        "layer_highest": highest(state.clouds, baked["fields"]),
        "cloud_drift": drift(state),
        "cloud_side": cloud_side(state),
        "cloud_repeats": 0.0 if state.clouds.kind == "asset" and not state.clouds.repeats else 1.0,
        "cloud_widens": float(state.clouds.kind == "procedural"),
        "sun_direction": direction(state.sun),
        "sun_irradiance": (SOLAR_CONSTANT,) * 3,
    }


def air_frame(eye: Any, radius: float, sun: Any) -> dict[str, Any]:
    """Axes and limits of the air's table at a camera (3,) [m] over a planet of that radius [m]."""
    from_centre = np.asarray(eye, np.float64) + (0.0, 0.0, radius)
    distance = max(float(np.linalg.norm(from_centre)), radius + 1.0)
    up = from_centre / np.linalg.norm(from_centre)
    level = np.asarray(sun, np.float64) - np.dot(sun, up) * up
    if np.linalg.norm(level) < 1e-6:
        level = np.cross(up, (1.0, 0.0, 0.0) if abs(up[0]) < 0.9 else (0.0, 1.0, 0.0))
    above = distance > radius + AIR_TOP
    east = np.cross(up, (0.0, 1.0, 0.0) if abs(up[1]) < 0.9 else (1.0, 0.0, 0.0))
    east /= -np.linalg.norm(east)
    ahead = level / np.linalg.norm(level)
    turn = math.atan2(np.dot(ahead, np.cross(up, east)), np.dot(ahead, east)) / (2 * math.pi) + 0.5
    return {
        "air_up": tuple(up),
        "air_ahead": tuple(ahead),
        "air_east": tuple(east),
        "air_turn": turn,
        "air_horizon": math.pi - math.asin(radius / distance),
        "air_limb": math.pi - math.asin((radius + AIR_TOP) / distance) if above else 0.0,
    }


def variant_of(state: CloudsState, values: Mapping[str, Any]) -> Variant:
    """What of the picture's case is compiled in."""
    eye = np.asarray(values["camera_origin"], np.float64) + (0.0, 0.0, state.planet.radius)
    altitude = float(np.linalg.norm(eye)) - state.planet.radius
    table = state.camera.kind != "orthographic"
    top = state.layer.base + state.layer.thickness * float(values["layer_highest"])
    high = float(np.asarray(values["sun_direction"]) @ eye) / float(np.linalg.norm(eye)) > math.sin(LOW_SUN)
    return Variant(
        sky=state.view.background == "sky",
        table=table,
        side=(-1 if altitude < state.layer.base else int(altitude > top)) if table else 0,
        twilight=not (table and high and altitude < AIR_TOP / 2),
        land=values["land_top"] > 0,
    )


def shows_disc(values: Mapping[str, Any]) -> bool:
    """Whether the sun's disc may be in a picture, by the uniforms of its camera, size and sun."""
    sun, size = np.asarray(values["sun_direction"], np.float64), values["picture_size"]
    corner, dx, dy = (np.asarray(values[f"camera_{name}"], np.float64) for name in ("corner", "dx", "dy"))
    corners = [corner + x * dx + y * dy for x in (0, size[0]) for y in (0, size[1])]
    middle = corner + 0.5 * (size[0] * dx + size[1] * dy)
    widest = max(_between(middle, one) for one in corners)
    return _between(middle, sun) < widest + 2 * ANGULAR_RADIUS


def _between(a: np.ndarray, b: np.ndarray) -> float:
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))


def excess(eye: Any, radius: float) -> tuple[float, float]:
    """|q|^2 - R^2 of an eye [m] from the planet's centre, as a pair of floats whose sum it is, m2."""
    x, y, z = (float(np.float32(c)) for c in eye)
    whole = x * x + y * y + z * z + 2.0 * float(np.float32(radius)) * z
    high = float(np.float32(whole))
    return high, whole - high


def globe_axes(latitude: float, longitude: float) -> dict[str, tuple[float, float, float]]:
    """The Earth's axes in the site's (east, north, up): towards 0 E and 90 E on the equator, and the north pole.

    Args:
        latitude, longitude: of the site, degrees.
    """
    lat, lon = math.radians(latitude), math.radians(longitude)
    east = (-math.sin(lon), math.cos(lon), 0.0)
    north = (-math.sin(lat) * math.cos(lon), -math.sin(lat) * math.sin(lon), math.cos(lat))
    up = (math.cos(lat) * math.cos(lon), math.cos(lat) * math.sin(lon), math.sin(lat))
    names = ("globe_east", "globe_north", "globe_up")
    return {name: (east[k], north[k], up[k]) for k, name in enumerate(names)}


def moves(state: CloudsState) -> bool:
    """Whether the cloud map changes as time runs."""
    return state.clouds.kind == "procedural" and state.clouds.evolution > 0


def drift(state: CloudsState) -> tuple[float, float]:
    """How far the wind has carried the map, east and north, m."""
    way, azimuth = state.layer.wind * state.time, math.radians(state.layer.wind_azimuth)
    return way * math.sin(azimuth), way * math.cos(azimuth)


def cloud_side(state: CloudsState) -> float:
    """Side of the square that the cloud map covers, m."""
    return 1000.0 if state.clouds.kind == "uniform" else state.clouds.side


def pixel_angle(state: CloudsState, size: tuple[int, int]) -> float:
    """Width of a pixel of a picture (width, height), rad; 0 in a parallel view."""
    if isinstance(state.camera, Orthographic):
        return 0.0
    return 2 * math.tan(math.radians(state.camera.field_of_view) / 2) / size[1]
