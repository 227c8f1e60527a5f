"""The weather systems of the whole Earth: where the sky is open and where it is closed.

Cover follows the mean of each latitude: rain north of the equator, clear deserts under the subtropical highs, storm
tracks at 50 degrees, grey poles (Rossow and Schiffer 1999, figure 3). Noise drawn out along the parallels makes banks
of it, and vortices at the latitudes of storms wind these into spirals.

Deviations: no winds blow and no fronts move; seasons, coasts and mountains do not matter.
"""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np
from scipy.ndimage import map_coordinates, spline_filter

ROWS, COLUMNS = 512, 1024
"""Of the map in latitude and longitude: 39 km at the equator."""

ROUND_SITE = 1024
"""Texels a side of the map round a site, 25 km each there."""

LATITUDES = (-90, -65, -50, -25, -15, 0, 7, 15, 25, 45, 60, 75, 90)
COVERS = (0.4, 0.7, 0.7, 0.3, 0.25, 0.4, 0.55, 0.3, 0.2, 0.5, 0.65, 0.6, 0.5)
"""Mean cover by latitude, degrees, in rough tenths (Rossow and Schiffer 1999, figure 3)."""

LATTICE = 32
"""Nodes a side of the cube of random numbers that noise is read from."""

STORMS = 22
"""Vortices."""

CLOSED = 4.0e5
"""Distance from the site within which the sky is closed, so that the layer's own map shows, m."""


def systems(rng: np.random.Generator) -> np.ndarray:
    """Share of the layer's thickness over the Earth, (512, 1024) float32 in [0, 1], row 0 at the south pole, column 0
    at 180 degrees west."""
    latitude = (np.arange(ROWS) + 0.5) * math.pi / ROWS - math.pi / 2
    longitude = (np.arange(COLUMNS) + 0.5) * 2 * math.pi / COLUMNS - math.pi
    level = np.cos(latitude)[:, None]
    points = np.stack(
        [level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude)[:, None] * np.ones(COLUMNS)], axis=-1
    )
    wound = _wound(rng, points.reshape(-1, 3))
    field = _noise(rng, wound * (1.0, 1.0, 2.2), 2.6, 7)
    fleecy = _noise(rng, 0.5 * (wound + points.reshape(-1, 3)), 22.0, 4)
    cover = np.interp(np.degrees(latitude), LATITUDES, COVERS)[:, None]
    # A logistic curve stands for the normal distribution: the threshold above which `cover` of the field lies.
    threshold = np.log(1.0 / cover - 1.0) / 1.702
    above = (field + 0.45 * fleecy).reshape(ROWS, COLUMNS) - 1.1 * threshold
    share = np.clip(0.4 + 0.45 * above, 0.0, 1.0)
    return (share * share * (3.0 - 2.0 * share)).astype(np.float32)


def _wound(rng: np.random.Generator, points: np.ndarray) -> np.ndarray:
    """Unit vectors (N, 3) turned about each storm's middle, most where it is near."""
    for _ in range(STORMS):
        north = rng.random() < 0.5
        angle = math.radians(rng.normal(48.0, 9.0)) * (1 if north else -1)
        along = rng.uniform(-math.pi, math.pi)
        middle = np.array([math.cos(angle) * math.cos(along), math.cos(angle) * math.sin(along), math.sin(angle)])
        size = math.radians(rng.uniform(5.0, 11.0))
        apart2 = np.maximum(2.0 - 2.0 * points @ middle, 0.0)
        near = np.flatnonzero(apart2 < 9.0 * size * size)
        turn = rng.uniform(2.0, 4.0) * (-1 if north else 1) * np.exp(-apart2[near] / (size * size))
        p, c, s = points[near], np.cos(turn)[:, None], np.sin(turn)[:, None]
        points = points.copy()
        points[near] = p * c + np.cross(middle, p) * s + middle * (p @ middle)[:, None] * (1 - c)
    return points


def _noise(rng: np.random.Generator, points: np.ndarray, frequency: float, octaves: int) -> np.ndarray:
    """Smooth noise at points (N, 3), each octave twice as fine, 0.66 times as strong and turned."""
    total = np.zeros(len(points))
    for octave in range(octaves):
        lattice = spline_filter(rng.standard_normal((LATTICE,) * 3), order=2, mode="grid-wrap")
        turned, _ = np.linalg.qr(rng.standard_normal((3, 3)))
        at = points @ turned * frequency * 2.0**octave + rng.uniform(0, LATTICE, 3)
        total += 0.66**octave * map_coordinates(lattice, at.T, order=2, mode="grid-wrap", prefilter=False)
    return np.asarray((total - total.mean()) / total.std())


FRONT = 5.0e4
"""Distance over which the layer thins out at its front, m: two texels of the map round a site."""


def layer_round_site(found: np.ndarray, planet: Any, layer: Any) -> np.ndarray:
    """What weather and the layer's own front leave of it round a document's site: as of `round_site`.

    Args:
        found: of `systems`. planet, layer: of the document.
    """
    sky = round_site(found, planet.latitude, planet.longitude, planet.radius)
    if layer.ends <= 0:
        return sky
    axis = (np.arange(ROUND_SITE) + 0.5) / ROUND_SITE * 2 - 1
    east, north = np.meshgrid(axis, axis)
    azimuth = math.radians(layer.ends_azimuth)
    half = np.minimum(np.hypot(east, north), 1.0)
    # The front is a circle of latitude round the far pole: places as far along the azimuth as the layer reaches.
    along = (east * math.sin(azimuth) + north * math.cos(azimuth)) * 2 * np.sqrt(1 - half**2)
    ahead = planet.radius * np.arcsin(np.clip(along, -1, 1))
    inside = np.clip(0.5 - (ahead - layer.ends) / FRONT, 0, 1)
    return np.asarray((inside * inside * (3 - 2 * inside)) * (sky if len(sky) == ROUND_SITE else 1.0), np.float32)


def round_site(found: np.ndarray, latitude: float, longitude: float, radius: float) -> np.ndarray:
    """The same as a map round a site, and closed over it.

    Args:
        found: of `systems`, or any map smaller than 8 rows, which says the same everywhere.
        latitude, longitude: degrees. radius: of the planet, m.

    Returns:
        (1024, 1024) in Lambert's equal-area projection, sin(distance / 2 R) towards the east and the north from -1 to
        1, row 0 at the south; beyond the antipode, its rim goes on.
    """
    if len(found) < 8:
        return found
    if found.shape != (ROWS, COLUMNS):
        raise ValueError("no map of the Earth's weather")
    return _round_site(found.tobytes(), latitude, longitude, radius)


@functools.lru_cache(maxsize=4)
def _round_site(found: bytes, latitude: float, longitude: float, radius: float) -> np.ndarray:
    systems_map = np.frombuffer(found, np.float32).reshape(ROWS, COLUMNS)
    axis = (np.arange(ROUND_SITE) + 0.5) / ROUND_SITE * 2 - 1
    east, north = np.meshgrid(axis, axis)
    half = np.minimum(np.hypot(east, north), 1.0)  # sine of half the distance
    scale = 2 * np.sqrt(1 - half**2)
    up = 1 - 2 * half**2
    lat, lon = math.radians(latitude), math.radians(longitude)
    pole = scale * north * math.cos(lat) + up * math.sin(lat)
    outward = -scale * north * math.sin(lat) + up * math.cos(lat)
    row = (np.arcsin(np.clip(pole, -1, 1)) / math.pi + 0.5) * ROWS - 0.5
    column = ((np.arctan2(scale * east, outward) + lon) / (2 * math.pi) + 0.5) * COLUMNS - 0.5
    rows = np.pad(systems_map, ((1, 1), (0, 0)), mode="edge")
    there = map_coordinates(rows, [np.clip(row, -0.5, ROWS - 0.5) + 1, column], order=1, mode="grid-wrap")
    closed = np.exp(-((2 * radius * np.arcsin(half) / CLOSED) ** 2))
    return np.asarray(there + closed * (1 - there), np.float32)
