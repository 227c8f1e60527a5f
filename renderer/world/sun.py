"""The sun: a direction, or a moment at a place.

Positions follow the Solar Position Algorithm (Reda and Andreas, 2004, NREL/TP-560-34302) as pvlib carries it. Light
in a scene travels straight, so a moment's sun stands where it is seen: at its apparent (refracted) elevation.
"""

from __future__ import annotations

import datetime
import functools
import math
import zoneinfo
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from renderer.core.errors import InputError
from renderer.core.params import Model, param

Angles = NDArray[np.float64]

ANGULAR_RADIUS = math.radians(0.2666)
"""Half the angle the sun's disc fills at one astronomical unit, in radians."""

RISING = math.radians(-0.26667 - 0.5667)
"""True elevation of the sun's centre when its upper edge touches a level horizon, in radians (SPA, section A.2)."""

FADED = math.radians(-6.0)
"""True elevation below which no refraction is applied, in radians: the end of civil twilight."""

TEMPERATURE = 12.0
"""Yearly mean air temperature for refraction, in degrees Celsius: pvlib's own default."""

PATH_STEPS = 289
"""Points of a day's path: every five minutes of 24 hours."""


class SunDirection(Model):
    """The sun where it is seen, by azimuth and elevation."""

    kind: Literal["direction"] = "direction"
    azimuth: float = param(
        135.0, label="Azimuth", help="Direction of the sun, clockwise from north.", unit="deg", ge=0, le=360, step=0.25
    )
    elevation: float = param(
        45.0, label="Elevation", help="Height of the sun above the horizon.", unit="deg", ge=-90, le=90, step=0.25
    )


@functools.cache
def time_zones() -> frozenset[str]:
    """Names of the known time zones."""
    return frozenset(zoneinfo.available_timezones())


def calendar_day(text: str) -> str:
    """A day of the calendar, year-month-day, as a validator of fields takes it."""
    try:
        year = datetime.date.fromisoformat(text).year
    except ValueError:
        raise PydanticCustomError("date", "is no day of the calendar") from None
    if not 1600 <= year <= 2999:
        raise PydanticCustomError("date", "lies outside the years 1600 to 2999")
    return text


def known_zone(name: str) -> str:
    """The name of a time zone that is known, as a validator of fields takes it."""
    if name not in time_zones():
        raise PydanticCustomError("time_zone", "is not a known time zone; a name is Area/City, as Europe/Paris")
    return name


class SunMoment(Model):
    """The sun at a date, a time and a place."""

    kind: Literal["moment"] = "moment"
    date: str = param(
        "2024-06-21",
        label="Date",
        help="Day of the local calendar, year-month-day.",
        unit="date",
        pattern=r"^\d{4}-\d{2}-\d{2}$",
        max_length=10,
    )
    time_zone: str = param("UTC", label="Time zone", help="Name of the time zone, as Europe/Paris.", max_length=64)
    time: str = param(
        "12:00:00",
        label="Time",
        help="Time of the local clock; the earlier where it repeats an hour.",
        pattern=r"^\d{2}:\d{2}(:\d{2})?$",
        max_length=8,
    )
    latitude: float = param(45.0, label="Latitude", help="Degrees north of the equator.", unit="deg", ge=-90, le=90)
    longitude: float = param(0.0, label="Longitude", help="Degrees east of Greenwich.", unit="deg", ge=-180, le=180)
    altitude: float = param(0.0, label="Altitude", help="Height above the sea.", unit="m", ge=-500, le=9000)

    _calendar = field_validator("date")(calendar_day)
    _known = field_validator("time_zone")(known_zone)

    @field_validator("time")
    @classmethod
    def _exists(cls, text: str, info: ValidationInfo) -> str:
        try:
            clock = datetime.time.fromisoformat(text)
        except ValueError:
            raise PydanticCustomError("time", "is no time of day, 00:00:00 to 23:59:59") from None
        if "date" in info.data and "time_zone" in info.data:
            day = datetime.date.fromisoformat(info.data["date"])
            local = datetime.datetime.combine(day, clock, zoneinfo.ZoneInfo(info.data["time_zone"]))
            back = local.astimezone(datetime.UTC).astimezone(local.tzinfo)
            if back.replace(tzinfo=None) != local.replace(tzinfo=None):
                raise PydanticCustomError("time", "does not exist: the clocks are put forward over it that day")
        return text


Sun = Annotated[SunDirection | SunMoment, Field(discriminator="kind")]


def moment(sun: SunMoment) -> datetime.datetime:
    """The instant a sun stands for, in its own time zone."""
    return datetime.datetime.combine(
        datetime.date.fromisoformat(sun.date), datetime.time.fromisoformat(sun.time), zoneinfo.ZoneInfo(sun.time_zone)
    )


@dataclass(frozen=True)
class Position:
    """Where the sun stands, in radians: `azimuth` clockwise from north in [0, 2 pi), `elevation` of its centre without
    refraction, `apparent_elevation` as seen through the air. Arrays of one shape."""

    azimuth: Angles
    elevation: Angles
    apparent_elevation: Angles


def positions(unix_seconds: Any, latitude: float, longitude: float, altitude: float) -> Position:
    """The sun at instants and a place.

    Args:
        unix_seconds: seconds since 1970-01-01 UTC, (N,).
        latitude, longitude: degrees north and east.
        altitude: m above the sea; it also sets the air pressure of refraction (U.S. Standard Atmosphere, 1976).

    Returns:
        arrays (N,), in radians.
    """
    from pvlib import atmosphere, spa  # over a second to import, and only moments need it

    times = np.atleast_1d(np.asarray(unix_seconds, dtype=np.float64))
    middle = datetime.datetime(1970, 1, 1) + datetime.timedelta(seconds=float(times[len(times) // 2]))
    delta_t = float(spa.calculate_deltat(middle.year, middle.month))
    pressure = float(atmosphere.alt2pres(altitude)) / 100.0
    result = spa.solar_position_numpy(times, latitude, longitude, altitude, pressure, TEMPERATURE, delta_t, 0.5667, 1)
    elevation = np.radians(result[3])
    return Position(np.radians(result[4]) % (2.0 * np.pi), elevation, elevation + _refraction(elevation, pressure))


def _refraction(elevation: Angles, pressure: float) -> Angles:
    """Refraction in radians at a true elevation (SPA, eq. 42), let fade out below the horizon.

    SPA drops it at once when the sun has set, a step of 0.6 degrees which a moving sun would show; no observation there
    says what is right, so from the rising elevation down to `FADED` it falls linearly to zero.
    """
    degrees = np.degrees(np.maximum(elevation, RISING))
    density = pressure / 1010.0 * 283.0 / (273.0 + TEMPERATURE)
    full = density * 1.02 / (60.0 * np.tan(np.radians(degrees + 10.3 / (degrees + 5.11))))
    return np.radians(full) * np.clip((elevation - FADED) / (RISING - FADED), 0.0, 1.0)


@functools.lru_cache(maxsize=4096)
def _moment_angles(sun: SunMoment) -> tuple[float, float]:
    found = positions([moment(sun).timestamp()], sun.latitude, sun.longitude, sun.altitude)
    return float(found.azimuth[0]), float(found.apparent_elevation[0])


def angles(sun: SunDirection | SunMoment) -> tuple[float, float]:
    """Azimuth (clockwise from north) and apparent elevation of the sun, in radians."""
    if isinstance(sun, SunDirection):
        return math.radians(sun.azimuth), math.radians(sun.elevation)
    return _moment_angles(sun)


def direction(sun: SunDirection | SunMoment) -> NDArray[np.float64]:
    """Unit vector from the scene to the sun, (3,): x east, y north, z up."""
    azimuth, elevation = angles(sun)
    flat = math.cos(elevation)
    return np.array([math.sin(azimuth) * flat, math.cos(azimuth) * flat, math.sin(elevation)])


@dataclass(frozen=True)
class Day:
    """The sun over one local calendar day.

    Attributes:
        sunrise, sunset: first rising and last setting of the upper edge over a level horizon, in local time; None
            where the day has none.
        always: "up" on a polar day, "down" in a polar night, else "".
        seconds: time of each point of the path since local midnight, (N,) in s.
        azimuth, elevation: the path, (N,) in radians; elevation is apparent.
    """

    sunrise: datetime.datetime | None
    sunset: datetime.datetime | None
    always: Literal["up", "down", ""]
    seconds: NDArray[np.float64]
    azimuth: Angles
    elevation: Angles


def day(sun: SunDirection | SunMoment) -> Day:
    """Sunrise, sunset and path of the sun over the day of a moment.

    Raises:
        InputError: a sun given by its direction, which has no day.
    """
    if isinstance(sun, SunDirection):
        raise InputError("sun.kind", "a sun given by its direction has no day", "moment")
    zone = zoneinfo.ZoneInfo(sun.time_zone)
    date = datetime.date.fromisoformat(sun.date)
    start = datetime.datetime.combine(date, datetime.time(), zone).timestamp()
    end = datetime.datetime.combine(date + datetime.timedelta(days=1), datetime.time(), zone).timestamp()
    times = np.linspace(start, end, PATH_STEPS)
    path = positions(times, sun.latitude, sun.longitude, sun.altitude)
    above = path.elevation > RISING
    rises, sets = np.flatnonzero(~above[:-1] & above[1:]), np.flatnonzero(above[:-1] & ~above[1:])
    sunrise = _crossing(sun, times, int(rises[0]), zone) if rises.size else None
    sunset = _crossing(sun, times, int(sets[-1]), zone) if sets.size else None
    always: Literal["up", "down", ""] = "" if rises.size or sets.size else ("up" if above[0] else "down")
    return Day(sunrise, sunset, always, times - start, path.azimuth, path.apparent_elevation)


def _crossing(sun: SunMoment, times: NDArray[np.float64], step: int, zone: zoneinfo.ZoneInfo) -> datetime.datetime:
    """The instant, to a second, at which the sun passes the rising elevation within one step of the path."""
    fine = np.linspace(times[step], times[step + 1], 301)
    height = positions(fine, sun.latitude, sun.longitude, sun.altitude).elevation - RISING
    order = np.argsort(height)
    crossing = float(np.interp(0.0, height[order], fine[order]))
    return datetime.datetime.fromtimestamp(crossing, zone).replace(microsecond=0)
