"""Where on Earth a terrain is: enough to measure metres, place the sun and write the file back."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

SEMI_MAJOR = 6_378_137.0
FLATTENING = 1 / 298.257223563
"""WGS 84 (NIMA 2000, table 3.1); GRS 80 differs by 0.1 mm, which no terrain notices."""

ECCENTRICITY_2 = FLATTENING * (2 - FLATTENING)

WEB_MERCATOR = 3857


@dataclass(frozen=True)
class Crs:
    """A coordinate system.

    Args:
        epsg: its EPSG code, None where the file defines its own.
        geographic: longitude and latitude in degrees (true) or a projection (false).
        unit: metres on the ground per unit of x and of y, at the terrain's centre.
        tags: GeoTIFF tags (code, type, value) to be written back unchanged; empty where `epsg` says all.
    """

    epsg: int | None
    geographic: bool
    unit: tuple[float, float] = (1.0, 1.0)
    tags: tuple[tuple[int, str, Any], ...] = ()


def metres_per_degree(latitude: float) -> tuple[float, float]:
    """Length of a degree of longitude and of latitude on the WGS 84 ellipsoid.

    Args:
        latitude: degrees.

    Returns:
        metres per degree of longitude and of latitude: the radii of curvature in the prime vertical (times the cosine)
        and in the meridian (Torge 2001, Geodesy, eqs. 4.12-4.13).
    """
    phi = math.radians(latitude)
    w = 1 - ECCENTRICITY_2 * math.sin(phi) ** 2
    meridian = SEMI_MAJOR * (1 - ECCENTRICITY_2) / w**1.5
    prime_vertical = SEMI_MAJOR / math.sqrt(w)
    return math.radians(prime_vertical * math.cos(phi)), math.radians(meridian)


def utm_zone(epsg: int | None) -> tuple[int, bool] | None:
    """Zone and whether it is southern, for the UTM codes of WGS 84, ETRS 89 and NAD 83; None for other systems."""
    if epsg is None:
        return None
    for first, zones, south in (
        (32600, range(1, 61), False),
        (32700, range(1, 61), True),
        (25800, range(28, 39), False),
        (26900, range(1, 24), False),
    ):
        if epsg - first in zones:
            return epsg - first, south
    return None


def place(crs: Crs, x: float, y: float) -> tuple[float, float] | None:
    """Latitude and longitude (degrees) of a point of `crs`, or None where the system is not known here.

    Known: longitude and latitude themselves, UTM, and Web Mercator. Others need a projection library; the sun's place
    is then the user's to say.
    """
    if crs.geographic:
        return y, x
    if crs.epsg == WEB_MERCATOR:
        return math.degrees(math.atan(math.sinh(y / SEMI_MAJOR))), math.degrees(x / SEMI_MAJOR)
    zone = utm_zone(crs.epsg)
    return None if zone is None else _from_utm(x, y, *zone)


def north_of(crs: Crs, x: float, y: float) -> float:
    """Bearing of the grid's north from true north at a point of `crs`, clockwise, in radians: the meridian convergence.

    0 where the system is not known here; longitude and latitude and Web Mercator have none.
    """
    step = 100.0 / crs.unit[1]
    here, ahead = place(crs, x, y), place(crs, x, y + step)
    if here is None or ahead is None:
        return 0.0
    east, north = metres_per_degree(here[0])
    return math.atan2((ahead[1] - here[1]) * east, (ahead[0] - here[0]) * north)


def _from_utm(easting: float, northing: float, zone: int, south: bool) -> tuple[float, float]:
    """Inverse transverse Mercator, degrees: Krueger's series to third order, below 1 mm within a zone.

    Source: Kawase 2011, "A general formula for calculating meridian arc length", as the UTM formulas in beta and delta.
    """
    n = FLATTENING / (2 - FLATTENING)
    rectifying = SEMI_MAJOR / (1 + n) * (1 + n**2 / 4 + n**4 / 64)
    xi = (northing - (10_000_000.0 if south else 0.0)) / (0.9996 * rectifying)
    eta = (easting - 500_000.0) / (0.9996 * rectifying)
    beta = (n / 2 - 2 * n**2 / 3 + 37 * n**3 / 96, n**2 / 48 + n**3 / 15, 17 * n**3 / 480)
    xi_prime = xi - sum(b * math.sin(2 * k * xi) * math.cosh(2 * k * eta) for k, b in enumerate(beta, 1))
    eta_prime = eta - sum(b * math.cos(2 * k * xi) * math.sinh(2 * k * eta) for k, b in enumerate(beta, 1))
    chi = math.asin(math.sin(xi_prime) / math.cosh(eta_prime))
    delta = (2 * n - 2 * n**2 / 3 - 2 * n**3, 7 * n**2 / 3 - 8 * n**3 / 5, 56 * n**3 / 15)
    phi = chi + sum(d * math.sin(2 * k * chi) for k, d in enumerate(delta, 1))
    longitude = 6 * zone - 183 + math.degrees(math.atan2(math.sinh(eta_prime), math.cos(xi_prime)))
    return math.degrees(phi), longitude
