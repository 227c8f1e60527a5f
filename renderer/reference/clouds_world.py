"""The clouds' world as the reference reads it: plain arrays in, tables for its compiled functions out."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from renderer.core.errors import InputError
from renderer.reference.clouds_phase import scatter
from renderer.world.atmosphere import (
    MIE,
    MIE_ABSORPTION,
    MIE_HEIGHT,
    OZONE,
    OZONE_HEIGHT,
    OZONE_SPREAD,
    RAYLEIGH,
    RAYLEIGH_HEIGHT,
)

Floats = NDArray[np.float64]

AIR_TOP = 1e5
"""Altitude above which there is no air, m (Hillaire 2020, section 5)."""

DEPTHS = (96, 256)
"""Altitudes and directions of the table of optical depths to the top of the air."""

COARSE = 2000.0
"""Longest step through an even layer, m."""


@dataclass(frozen=True)
class CloudsWorld:
    """What stands where, in metres, z up from the site, and the light it stands in.

    Attributes:
        radius: of the planet, whose centre is at (0, 0, -radius).
        albedo, snow_albedo: of the site's ground, below and above `snow_line`; site_size: radius of the site;
            rock_albedo: of its land on slopes above `steepest` [rad].
        globe: (rows, columns, 3) albedo beyond it, row 0 at the south pole, column 0 at 180 degrees west.
        globe_axes: (3, 3), towards 0 E and 90 E on the equator and towards the pole, in the site's axes.
        height: (N, N) of the land, row 0 at the south, nodes `land_cell` apart round the site, 0 outside.
        base, thickness, extinction: of the layer; extinction per m.
        cloud_map: (N, N) share of the thickness, row 0 at the south, over `cloud_side`, which `cloud_repeats` or not,
            carried by `cloud_drift`; systems: (M, M) a further share, in Lambert's equal-area projection of the whole
            sphere round the site.
        moments: (3, L) of the droplets' phase function in each band, the first 1.
        sun: unit vector to the middle of its disc, of angular radius `sun_radius`; sun_irradiance: W m-2 above the air.
        haze: as a multiple of very clear air's; air: whether there is any.
        space: radiance that comes from all of the sky, W m-2 sr-1: what a furnace is lit by.
    """

    radius: float
    albedo: tuple[float, float, float]
    snow_albedo: tuple[float, float, float]
    snow_line: float
    rock_albedo: tuple[float, float, float]
    steepest: float
    site_size: float
    globe: NDArray[np.floating]
    globe_axes: NDArray[np.floating]
    height: NDArray[np.floating]
    land_cell: float
    base: float
    thickness: float
    extinction: float
    cloud_map: NDArray[np.floating]
    cloud_side: float
    cloud_repeats: bool
    cloud_drift: tuple[float, float]
    systems: NDArray[np.floating]
    moments: NDArray[np.floating]
    sun: tuple[float, float, float]
    sun_radius: float
    sun_irradiance: float
    haze: float
    air: bool = True
    space: float = 0.0


ALBEDO, SNOW, ROCK, RAYLEIGH_AT, OZONE_AT, SUN, EAST, NORTH, POLE, SHARE = range(10)
"""Rows of `Scene.triples`."""


class Scene(NamedTuple):
    """`CloudsWorld` for compiled functions, lengths in m and coefficients per m; few arrays, for each costs time
    whenever one function calls another.

    Attributes:
        triples: what there is one of in each band or along each axis.
        land_steepness, steepness: bounds of the rise over run of the land and of the layer's upper side.
        top: altitude that no cloud reaches. step: of a line through the layer.
        cloud_map, systems: with their first row and column once more at the end; (2, 2) systems are 1 everywhere.
        rayleigh, ozone, mie, mie_lost: of the air at sea level, its haze's scattering and extinction.
        depths: of `_depths`. tables, guides: of `clouds_phase`.
    """

    triples: Floats
    radius: float
    snow_line: float
    holds: float
    site_size: float
    globe: Floats
    height: Floats
    land_cell: float
    land_top: float
    land_steepness: float
    base: float
    thickness: float
    top: float
    step: float
    steepness: float
    extinction: float
    cloud_map: Floats
    cloud_side: float
    cloud_repeats: bool
    drift_east: float
    drift_north: float
    systems: Floats
    sun_radius: float
    irradiance: float
    space: float
    mie: float
    mie_lost: float
    depths: Floats
    tables: Floats
    guides: NDArray[np.int64]


def prepare(world: CloudsWorld) -> Scene:
    """Tables of a world.

    Raises:
        InputError: arrays that do not fit, or a sun without direction.
    """
    for name, array in (("height", world.height), ("cloud_map", world.cloud_map), ("systems", world.systems)):
        if array.ndim != 2 or min(array.shape) < 2:
            raise InputError(name, f"has shape {array.shape}", "(N, N), N at least 2")
    sun = np.asarray(world.sun, np.float64)
    if abs(float(np.linalg.norm(sun)) - 1.0) > 1e-6:
        raise InputError("sun", "is no unit vector")
    height = np.ascontiguousarray(world.height, np.float64)
    share, systems = np.asarray(world.cloud_map, np.float64), np.asarray(world.systems, np.float64)
    if float(np.ptp(systems)) == 0.0:
        share, systems = share * systems[0, 0], np.ones((1, 1))
    even = float(np.ptp(share)) == 0.0 and systems.shape[0] == 1
    there = 1e-3 if world.air else 0.0
    mie, lost = there * world.haze * MIE, there * world.haze * (MIE + MIE_ABSORPTION)
    tables = scatter(np.asarray(world.moments, np.float64))
    triples = np.stack([world.albedo, world.snow_albedo, world.rock_albedo, there * RAYLEIGH, there * OZONE, sun,
                        *np.asarray(world.globe_axes), tables.share]).astype(np.float64)  # fmt: skip
    return Scene(
        triples=triples, radius=world.radius, snow_line=world.snow_line, holds=math.cos(world.steepest),
        site_size=world.site_size, globe=np.ascontiguousarray(world.globe, np.float64), height=height,
        land_cell=world.land_cell, land_top=float(height.max()),
        land_steepness=float(np.hypot(*(np.abs(np.diff(height, axis=k)).max() / world.land_cell for k in (0, 1)))),
        base=world.base, thickness=world.thickness,
        top=world.base + max(world.thickness * float(share.max()) * float(systems.max()), 1e-3),
        step=COARSE if even else min(0.5 * world.cloud_side / share.shape[0], COARSE),
        extinction=max(world.extinction, 1e-12),
        steepness=_steepest(world, share), cloud_map=_padded(share), cloud_side=world.cloud_side,
        cloud_repeats=bool(world.cloud_repeats), drift_east=float(world.cloud_drift[0]),
        drift_north=float(world.cloud_drift[1]), systems=_padded(systems),
        sun_radius=world.sun_radius, irradiance=world.sun_irradiance, space=world.space, mie=mie, mie_lost=lost,
        depths=_depths(world.radius, triples[RAYLEIGH_AT], lost, triples[OZONE_AT]), tables=tables.values,
        guides=tables.guides,
    )  # fmt: skip


def _padded(table: Floats) -> Floats:
    """A periodic table with its first row and column once more at its end."""
    return np.ascontiguousarray(np.pad(table, ((0, 1), (0, 1)), mode="wrap"))


def _steepest(world: CloudsWorld, share: Floats) -> float:
    """Bound of the rise over run of the layer's upper side."""
    texel = world.cloud_side / share.shape[0]
    parts = [np.abs(np.diff(share, axis=axis, append=share.take([0], axis))).max() for axis in (0, 1)]
    return world.thickness * float(np.hypot(*parts)) / texel


def _depths(radius: float, rayleigh: Floats, mie_lost: float, ozone: Floats) -> Floats:
    """Optical depth of the air from a place to its top, no ground in the way, (altitudes, directions, 3).

    Row j: sqrt(r^2 - R^2) is j / (rows - 1) of its value at the top; column i: the way to the top is i / (columns - 1)
    of the way from the shortest to that along the horizon (Bruneton and Neyret 2008, section 4).
    """
    rows, columns = DEPTHS
    widest = math.sqrt(AIR_TOP * (2 * radius + AIR_TOP))
    rho = widest * np.arange(rows)[:, None] / (rows - 1)
    r = np.hypot(rho, radius)
    nearest = radius + AIR_TOP - r
    length = nearest + (rho + widest - nearest) * np.arange(columns)[None, :] / (columns - 1)
    along = np.where(length > 0, (widest**2 - rho**2 - length**2) / np.maximum(2 * length, 1e-9), r)  # r mu
    lowest = np.clip(-along, 0.0, length)
    before, behind = lowest ** (1 / 2.5), (length - lowest) ** (1 / 2.5)
    found = np.zeros((rows, columns, 3))
    edges = np.linspace(0, 1, 257)
    place = -before[..., None] + (before + behind)[..., None] * edges
    t = lowest[..., None] + np.sign(place) * np.abs(place) ** 2.5
    middle, step = 0.5 * (t[..., 1:] + t[..., :-1]), np.diff(t, axis=-1)
    altitude = np.sqrt(np.maximum((r**2)[..., None] + middle * (2 * along[..., None] + middle), 0)) - radius
    molecules, particles, layer = (np.einsum("ijk,ijk->ij", part, step) for part in densities(altitude))
    for band in range(3):
        found[..., band] = rayleigh[band] * molecules + mie_lost * particles + ozone[band] * layer
    return found


def densities(altitude: Floats) -> tuple[Floats, Floats, Floats]:
    """Molecules, haze and ozone at an altitude [m], each relative to where it is densest."""
    height = np.maximum(altitude, 0.0) * 1e-3
    ozone = np.maximum(0.0, 1.0 - np.abs(height - OZONE_HEIGHT) / OZONE_SPREAD)
    return np.exp(-height / RAYLEIGH_HEIGHT), np.exp(-height / MIE_HEIGHT), ozone
