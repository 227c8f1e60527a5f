"""The suns of a stretch of time at a place: where each stands, what it sends, and their sums by azimuth and elevation.

Suns are sorted into bins of azimuth and, in a bin, by elevation. Who knows a place's horizon along a bin's azimuth
finds with one search how long the sun stands above it and what it sends meanwhile: whether the range is a day or a
year, the work for the land is the same.

Assumed: a cloudless sky (Ineichen and Perez 2002) and one sun for the whole land. The sun counts by its centre, with
refraction.
"""

from __future__ import annotations

import datetime
import itertools
import zoneinfo
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import field_validator

from renderer.core.errors import InputError, LimitError
from renderer.core.params import Model, param
from renderer.world.sun import calendar_day, known_zone, positions

Floats = NDArray[np.float64]

BINS = 360
"""Bins of the whole circle. Those of one degree err by 0.05 % of a year's hours at most, on a real terrain."""

INSTANTS = 200_000
"""Most instants of a range: five years at a quarter of an hour."""


class SunlightPeriod(Model):
    """What a sun study is asked for: when, where, on what."""

    start: str = param(
        "2024-01-01",
        label="From",
        help="First day, of the local calendar.",
        unit="date",
        cost="host",
        pattern=r"^\d{4}-\d{2}-\d{2}$",
        max_length=10,
    )
    end: str = param(
        "2024-12-31",
        label="To",
        help="Last day; it counts, too.",
        unit="date",
        cost="host",
        pattern=r"^\d{4}-\d{2}-\d{2}$",
        max_length=10,
    )
    minutes: int = param(
        15, label="Step", help="Minutes that each position of the sun stands for.", cost="host", ge=1, le=60
    )
    time_zone: str = param(
        "UTC",
        label="Time zone",
        help="Whose midnights the days begin at, as Europe/Paris.",
        cost="host",
        max_length=64,
    )
    latitude: float | None = param(
        None, label="Latitude", help="Degrees north; left out, the land's own.", unit="deg", cost="host", ge=-90, le=90
    )
    longitude: float | None = param(
        None,
        label="Longitude",
        help="Degrees east; left out, the land's own.",
        unit="deg",
        cost="host",
        ge=-180,
        le=180,
    )
    receiver: Literal["ground", "canopy", "bare_ground"] = param(
        "ground",
        label="On",
        help="What the sun falls on: ground between trees, the top of the trees and what lies between, or bare ground, "
        "as if no tree stood.",
        cost="host",
    )
    turbidity: float = param(
        3.0,
        label="Turbidity",
        help="Linke's, at air mass 2: how many clean dry atmospheres dim as much; 2 in mountains, 5 over cities.",
        cost="host",
        ge=1,
        le=10,
        source="Ineichen and Perez 2002",
    )

    _calendar = field_validator("start", "end")(calendar_day)
    _known = field_validator("time_zone")(known_zone)


@dataclass(frozen=True)
class Place:
    """Where the land lies.

    Args:
        latitude, longitude: of its centre, degrees.
        bearing: of the grid's north from true north, clockwise, rad.
        altitudes: of its lowest and highest point, m above the sea; the light of any height lies between theirs.
    """

    latitude: float
    longitude: float
    bearing: float
    altitudes: tuple[float, float]


@dataclass(frozen=True)
class Course:
    """All suns of a range above the level horizon; azimuths are the grid's.

    Args:
        azimuths: (B,) middles of the bins that hold suns, rad.
        firsts: (B + 1,) number of the first sun of each bin, then their count.
        tangents: (S,) of the suns' elevations, rising within a bin.
        sums: (S + B, 7) over the suns of bin b from its k-th on, at firsts[b] + b + k: hours, then beam irradiation
            of a plane that faces east, north and up, kWh m-2, at the lower and at the upper altitude.
        diffuse: (2,) irradiation of a level plane by the whole sky at both altitudes, kWh m-2.
    """

    azimuths: Floats
    firsts: NDArray[np.int64]
    tangents: Floats
    sums: Floats
    diffuse: Floats

    @property
    def hours(self) -> float:
        """Hours of sun on a plain."""
        return float(self.sums[self.firsts[:-1] + np.arange(len(self.azimuths)), 0].sum())


def instants(period: SunlightPeriod) -> tuple[Floats, Floats]:
    """The middle of each step, in s since 1970, and its length in h; from local midnight to local midnight.

    Steps run in true time, so that a day on which the clocks change has its 23 or 25 hours.

    Raises:
        InputError: the range ends before it begins.
        LimitError: more steps than the limit.
    """
    zone = zoneinfo.ZoneInfo(period.time_zone)
    first, last = (datetime.date.fromisoformat(text) for text in (period.start, period.end))
    if last < first:
        raise InputError("end", "lies before the first day", f"{period.start} or later")
    days = (last - first).days + 1
    if days * 1440 // period.minutes > INSTANTS:
        raise LimitError(
            "end",
            f"makes {days:,} days of {1440 // period.minutes} steps",
            f"at most {INSTANTS:,} steps in all: a shorter range or a longer step",
        )
    begin, over = (
        datetime.datetime.combine(day, datetime.time(), zone).timestamp()
        for day in (first, last + datetime.timedelta(days=1))
    )
    edges = np.append(np.arange(begin, over, period.minutes * 60.0), over)
    return (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 3600


def clear_sky(times: Floats, elevation: Floats, altitude: float, turbidity: float) -> tuple[Floats, Floats]:
    """Beam on a plane that faces the sun, and diffuse light on a level one, under a cloudless sky.

    Args:
        times: s since 1970. elevation: apparent, of the same suns, rad.
        altitude: m. turbidity: Linke's, at air mass 2.

    Returns:
        W m-2 each.

    Source: Ineichen and Perez 2002, as pvlib carries it; air mass of Kasten and Young 1989.
    """
    from pvlib import atmosphere, clearsky, irradiance  # over a second to import

    zenith = 90.0 - np.degrees(elevation)
    mass = atmosphere.get_absolute_airmass(atmosphere.get_relative_airmass(zenith), atmosphere.alt2pres(altitude))
    days = times.astype("datetime64[s]")
    of_year = (days.astype("datetime64[D]") - days.astype("datetime64[Y]").astype("datetime64[D]")).astype(float) + 1.0
    found = clearsky.ineichen(zenith, mass, turbidity, altitude, irradiance.get_extra_radiation(of_year))
    return np.nan_to_num(found["dni"]), np.nan_to_num(found["dhi"])


def course(period: SunlightPeriod, place: Place) -> Course:
    """The suns of a range at a place, sorted and summed.

    Raises:
        InputError, LimitError: a range that cannot be; naming the field.
    """
    times, hours = instants(period)
    middle = sum(place.altitudes) / 2
    found = positions(times, place.latitude, place.longitude, middle)
    up = found.apparent_elevation > 0
    times, hours, elevation = times[up], hours[up], found.apparent_elevation[up]
    azimuth = (found.azimuth[up] - place.bearing) % (2 * np.pi)
    sky = [clear_sky(times, elevation, altitude, period.turbidity) for altitude in place.altitudes]
    diffuse = np.array([(part[1] * hours).sum() / 1000 for part in sky])

    bins = np.minimum((azimuth / (2 * np.pi) * BINS).astype(np.int64), BINS - 1)
    order = np.lexsort((elevation, bins))
    used, starts = np.unique(bins[order], return_index=True)
    firsts = np.append(starts, len(order)).astype(np.int64)
    towards = np.stack([np.sin(azimuth) * np.cos(elevation), np.cos(azimuth) * np.cos(elevation), np.sin(elevation)], 1)
    beams = [towards * (part[0] * hours / 1000)[:, None] for part in sky]
    values = np.concatenate([hours[:, None], *beams], axis=1)[order]
    sums = np.zeros((len(order) + len(used), 1 + 3 * len(beams)))
    for number, (first, last) in enumerate(itertools.pairwise(firsts)):
        sums[first + number : last + number] = values[first:last][::-1].cumsum(axis=0)[::-1]
    return Course((used + 0.5) * (2 * np.pi / BINS), firsts, np.tan(elevation[order]), sums, diffuse)
