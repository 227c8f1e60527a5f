"""The clear air: its constants, the optical depth of a path through it, and its multiply scattered light.

Three bands stand for red, green and blue: 680, 550 and 440 nm (Bruneton and Neyret 2008, section 4). Lengths are in km
inside this file, because optical depths are then sums of numbers near one.
"""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from renderer.core.params import Model, param

Floats = NDArray[np.float64]

GROUND = 6360.0
"""Radius of the ground, in km (Hillaire 2020, table 1)."""

TOP = 6460.0
"""Radius above which there is no air, in km (Hillaire 2020, section 5)."""

RAYLEIGH = np.array([5.802e-3, 13.558e-3, 33.100e-3])
"""Scattering of the air molecules at sea level, per km and band (Hillaire 2020, table 1)."""

RAYLEIGH_HEIGHT = 8.0
"""Height over which the molecules thin out by a factor e, in km (Hillaire 2020, section 4)."""

MIE = 3.996e-3
"""Scattering of haze at sea level, per km (Hillaire 2020, table 1)."""

MIE_ABSORPTION = 0.444e-3
"""Absorption of haze at sea level, per km: scattering makes 0.9 of its extinction, 4.44e-3 (Bruneton 2017). Table 1 of
Hillaire 2020 prints that extinction, rounded to 4.40e-3, in its column of absorption; haze would be nearly black."""

MIE_HEIGHT = 1.2
"""Height over which haze thins out by a factor e, in km (Hillaire 2020, section 4)."""

MIE_ASYMMETRY = 0.8
"""Mean cosine of the scattering angle of haze (Hillaire 2020, section 4)."""

OZONE = np.array([0.650e-3, 1.881e-3, 0.085e-3])
"""Absorption of ozone where it is densest, per km and band (Hillaire 2020, table 1)."""

OZONE_HEIGHT, OZONE_SPREAD = 25.0, 15.0
"""Height where ozone is densest, and how far above and below it has gone, in km (Hillaire 2020, section 4)."""

DARKEST = 600.0
"""Optical depth at which transmittance is as good as zero and still no underflow."""

DEPTH_SHAPE = (64, 256)
"""Radii and directions of the optical-depth table (Hillaire 2020, section 5.5)."""

GLOW_HEIGHTS, GLOW_SUNS = 24, 49
"""Heights and sun cosines of the table of multiply scattered light."""

GLOW_LOWEST = -0.35
"""Lowest cosine of the sun's zenith angle in that table: all air that air at the top can see is dark there."""


class Atmosphere(Model):
    """What may be said about the air over a scene."""

    weather: Literal["clear", "overcast"] = param(
        "clear",
        label="Weather",
        help="A clear sky, or a closed layer of cloud that leaves no sun and a quarter of the light.",
        cost="bake",
        source="Moon and Spencer 1942; Kasten and Czeplak 1980",
    )
    altitude: float = param(
        0.0, label="Altitude", help="Height of the observer above the sea.", unit="m", cost="bake", ge=0, le=9000
    )
    haze: float = param(
        1.0,
        label="Haze",
        help="Amount of haze, as a multiple of that of very clear air (optical depth 0.0053); 20 is a common day.",
        unit="ratio",
        cost="bake",
        ge=0,
        le=100,
    )
    ground_albedo: float = param(
        0.15,
        label="Ground albedo",
        help="Share of light the wide land reflects.",
        unit="ratio",
        cost="bake",
        ge=0,
        le=1,
    )


@dataclass(frozen=True)
class Air:
    """Optical depths and multiply scattered light of one atmosphere.

    Attributes:
        haze, ground_albedo: as in `Atmosphere`.
        depth: optical depth to the top of the air, (radii, directions, 3), indexed as `_depth_place` says.
        glow: radiance of multiply scattered light per unit of solar irradiance, assumed the same in every direction,
            (heights, suns, 3) in 1/sr, indexed as `_glow_place` says.
    """

    haze: float
    ground_albedo: float
    depth: Floats
    glow: Floats


def densities(height: Floats) -> tuple[Floats, Floats, Floats]:
    """Molecules, haze and ozone at a height in km, each relative to where it is densest."""
    lifted = np.maximum(height, 0.0)
    ozone = np.maximum(0.0, 1.0 - np.abs(lifted - OZONE_HEIGHT) / OZONE_SPREAD)
    return np.exp(-lifted / RAYLEIGH_HEIGHT), np.exp(-lifted / MIE_HEIGHT), ozone


def coefficients(height: Floats, haze: float) -> tuple[Floats, Floats, Floats]:
    """Scattering by molecules, scattering by haze and whole extinction at a height in km; each (..., 3) per km."""
    molecules, particles, ozone = (d[..., None] for d in densities(height))
    rayleigh, mie = RAYLEIGH * molecules, np.broadcast_to(haze * MIE * particles, (*height.shape, 3))
    return rayleigh, mie, rayleigh + haze * (MIE + MIE_ABSORPTION) * particles + OZONE * ozone


def to_top(r: Floats, mu: Floats) -> Floats:
    """Distance in km from radius `r` to the top of the air, along a ray whose zenith cosine is `mu`."""
    return np.maximum(0.0, -r * mu + np.sqrt(np.maximum(0.0, r * r * (mu * mu - 1.0) + TOP * TOP)))


def to_ground(r: Floats, mu: Floats) -> Floats:
    """Distance in km to the ground, infinite where the ray passes it by."""
    inside = r * r * (mu * mu - 1.0) + GROUND * GROUND
    hits = (mu < 0.0) & (inside >= 0.0)
    return np.where(hits, np.maximum(0.0, -r * mu - np.sqrt(np.maximum(0.0, inside))), np.inf)


@functools.cache
def legendre(n: int) -> tuple[Floats, Floats]:
    """Nodes and weights of Gauss-Legendre quadrature on [0, 1]."""
    x, w = np.polynomial.legendre.leggauss(n)
    return 0.5 * (x + 1.0), 0.5 * w


def optical_depth(r: Floats, mu: Floats, haze: float, nodes: int = 64) -> Floats:
    """Optical depth from radius `r` (km) to the top of the air along zenith cosine `mu`, no ground, (..., 3)."""
    x, w = legendre(nodes)
    length = to_top(r, mu)
    t = length[..., None] * x
    height = np.sqrt(np.maximum(0.0, t * t + 2.0 * (r * mu)[..., None] * t + (r * r)[..., None])) - GROUND
    return np.einsum("...kc,k->...c", coefficients(height, haze)[2], w) * length[..., None]


def _depth_table(haze: float) -> Floats:
    """Optical depths on the grid of Bruneton and Neyret 2008, section 4, which is dense towards the horizon."""
    rows, columns = DEPTH_SHAPE
    widest = np.sqrt(TOP**2 - GROUND**2)
    rho = widest * np.linspace(0.0, 1.0, rows)[:, None]
    r = np.sqrt(rho**2 + GROUND**2)
    d = (TOP - r) + (rho + widest - (TOP - r)) * np.linspace(0.0, 1.0, columns)[None, :]
    mu = np.where(d > 0.0, (widest**2 - rho**2 - d**2) / np.maximum(2.0 * r * d, 1e-12), 1.0)
    return optical_depth(np.broadcast_to(r, mu.shape), np.clip(mu, -1.0, 1.0), haze)


def bilinear(table: Floats, y: Floats, x: Floats) -> Floats:
    """Bilinear interpolation of `table` (rows, columns, 3) at fractional indices."""
    rows, columns = table.shape[:2]
    y, x = np.clip(y, 0.0, rows - 1.0), np.clip(x, 0.0, columns - 1.0)
    j, i = np.minimum(y.astype(np.intp), rows - 2), np.minimum(x.astype(np.intp), columns - 2)
    fy, fx = (y - j)[..., None], (x - i)[..., None]
    flat, corner = table.reshape(-1, 3), j * columns + i
    low = flat[corner] * (1.0 - fx) + flat[corner + 1] * fx
    high = flat[corner + columns] * (1.0 - fx) + flat[corner + columns + 1] * fx
    return low * (1.0 - fy) + high * fy


def _depth_place(r: Floats, mu: Floats) -> tuple[Floats, Floats]:
    widest = np.sqrt(TOP**2 - GROUND**2)
    rho = np.sqrt(np.maximum(0.0, r * r - GROUND**2))
    nearest = TOP - r
    x = (to_top(r, mu) - nearest) / np.maximum(rho + widest - nearest, 1e-9)
    return rho / widest * (DEPTH_SHAPE[0] - 1), x * (DEPTH_SHAPE[1] - 1)


def transmittance(air: Air, r: Floats, mu: Floats) -> Floats:
    """Share of light that crosses the air from its top to radius `r` (km) along zenith cosine `mu`, (..., 3).

    Rays through the ground are not told apart: see `shadow`.
    """
    return np.exp(-np.minimum(bilinear(air.depth, *_depth_place(r, mu)), DARKEST))


def shadow(r: Floats, mu: Floats, radius: float) -> Floats:
    """Visible share of the sun's disc over the Earth's edge, from radius `r` (km), its centre at zenith cosine `mu`.

    Args:
        radius: of the disc, in radians; the share is a smoothstep across it (Bruneton 2017, GetTransmittanceToSun).
    """
    sine = np.minimum(1.0, GROUND / r)
    t = np.clip((mu + np.sqrt(1.0 - sine * sine)) / (2.0 * sine * radius) + 0.5, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _glow_place(r: Floats, mu: Floats) -> tuple[Floats, Floats]:
    y = np.sqrt(np.clip((r - GROUND) / (TOP - GROUND), 0.0, 1.0)) * (GLOW_HEIGHTS - 1)
    lowest = -np.sqrt(-GLOW_LOWEST)
    u = np.sign(mu) * np.sqrt(np.abs(mu))
    return y, (u - lowest) / (1.0 - lowest) * (GLOW_SUNS - 1)


def glow(air: Air, r: Floats, mu: Floats) -> Floats:
    """Radiance of light scattered twice or more, at radius `r` (km), sun at zenith cosine `mu`, (..., 3) in 1/sr."""
    return bilinear(air.glow, *_glow_place(r, mu))


def breathe(settings: Atmosphere, sun_radius: float) -> Air:
    """The tables of an atmosphere.

    Multiple scattering is the closed sum of Hillaire 2020, eq. 5 to 10: the second order, isotropic, divided by one
    minus the share of light that each further order hands on. The ground reflects the direct beam once.

    Args:
        settings: the air.
        sun_radius: angular radius of the sun, in radians.
    """
    bare = Air(
        settings.haze, settings.ground_albedo, _depth_table(settings.haze), np.zeros((GLOW_HEIGHTS, GLOW_SUNS, 3))
    )
    r = (GROUND + (TOP - GROUND) * np.linspace(0.0, 1.0, GLOW_HEIGHTS) ** 2)[:, None]
    u = np.linspace(-np.sqrt(-GLOW_LOWEST), 1.0, GLOW_SUNS)[None, :]
    r, mu_sun = np.broadcast_arrays(np.clip(r, GROUND + 1e-3, TOP - 1e-3), u * np.abs(u))
    second, share = np.zeros((*r.shape, 3)), np.zeros((*r.shape, 3))
    zenith, zenith_weight = legendre(16)
    around, around_weight = legendre(6)
    for cosine, w in zip(2.0 * zenith - 1.0, zenith_weight, strict=True):
        for azimuth, wa in zip(np.pi * around, around_weight, strict=True):
            light, passed = _one_direction(bare, r, mu_sun, float(cosine), float(azimuth), sun_radius)
            second += w * wa * light
            share += w * wa * passed
    return Air(bare.haze, bare.ground_albedo, bare.depth, second / (1.0 - share))


def _one_direction(
    air: Air, r: Floats, mu_sun: Floats, cosine: float, azimuth: float, sun_radius: float
) -> tuple[Floats, Floats]:
    """Light scattered once that comes along one direction, and what unit light everywhere would send (eq. 6, 8)."""
    mu = np.full_like(r, cosine)
    ground = to_ground(r, mu)
    length = np.minimum(to_top(r, mu), ground)
    facing = cosine * mu_sun + np.sqrt(1.0 - cosine**2) * np.sqrt(1.0 - mu_sun**2) * np.cos(azimuth)
    edges = np.linspace(0.0, 1.0, 25) ** 2
    light, passed, through = np.zeros((*r.shape, 3)), np.zeros((*r.shape, 3)), np.ones((*r.shape, 3))
    for near, far in itertools.pairwise(edges):
        t, step = 0.5 * (near + far) * length, ((far - near) * length)[..., None]
        here = np.clip(np.sqrt(np.maximum(0.0, r * r + t * t + 2.0 * r * mu * t)), GROUND, TOP)
        sun = np.clip((r * mu_sun + t * facing) / here, -1.0, 1.0)
        rayleigh, mie, extinction = coefficients(here - GROUND, air.haze)
        lost = np.exp(-np.minimum(extinction * step, DARKEST))
        weight = through * (rayleigh + mie) * (1.0 - lost) / extinction
        light += weight * transmittance(air, here, sun) * shadow(here, sun, sun_radius)[..., None] / (4.0 * np.pi)
        passed += weight
        through = through * lost
    hit = np.isfinite(ground)
    sun = np.where(hit, np.clip((r * mu_sun + length * facing) / GROUND, -1.0, 1.0), 0.0)
    beam = transmittance(air, np.full_like(r, GROUND), sun) * (np.maximum(sun, 0.0) * hit)[..., None]
    return light + through * air.ground_albedo / np.pi * beam, passed
