"""The sun against pvlib's own driver of the Solar Position Algorithm, and against the calendar's edges."""

from __future__ import annotations

import datetime
import math
import zoneinfo
from typing import Any

import numpy as np
import pandas as pd
import pytest
from pvlib import solarposition

from renderer.core.errors import InputError, InvalidDocument
from renderer.core.params import validate
from renderer.world import sun as suns
from renderer.world.state import SceneState
from renderer.world.sun import RISING, SunDirection, SunMoment, angles, day, direction, positions

PLACES = {
    "Grenoble": (45.19, 5.72, 212.0),
    "Quito": (-0.18, -78.47, 2850.0),
    "Hobart": (-42.88, 147.33, 0.0),
    "Longyearbyen": (78.22, 15.65, 10.0),
    "South Pole": (-90.0, 0.0, 2835.0),
    "North Pole": (90.0, 0.0, 0.0),
    "Kiritimati": (1.87, -157.4, 3.0),
}


def _turn(a: Any, b: Any) -> Any:
    return np.abs((np.degrees(a) - b + 180.0) % 360.0 - 180.0)


@pytest.mark.parametrize("place", PLACES)
def test_positions_agree_with_pvlib(place: str) -> None:
    """0.01 degrees, over years and seasons; the gap left is delta T (67 s there, by year here): 3e-4 degrees."""
    latitude, longitude, altitude = PLACES[place]
    starts = [
        pd.Timestamp(year, month, 17, tz="UTC") for year in (1955, 2004, 2026, 2090) for month in (1, 3, 6, 9, 12)
    ]
    times = pd.DatetimeIndex([start + k * pd.Timedelta(minutes=111) for start in starts for k in range(13)])
    expected = solarposition.get_solarposition(times, latitude, longitude, altitude=altitude, method="nrel_numpy")
    for year in np.unique(times.year):
        mask = times.year == year
        unix = (times[mask] - pd.Timestamp(0, tz="UTC")) / pd.Timedelta(seconds=1)
        found = positions(unix.to_numpy(), latitude, longitude, altitude)
        np.testing.assert_allclose(np.degrees(found.elevation), expected["elevation"][mask], atol=0.01)
        seen = expected["elevation"].to_numpy()[mask] > math.degrees(RISING)
        apparent = np.degrees(found.apparent_elevation)
        np.testing.assert_allclose(apparent[seen], expected["apparent_elevation"][mask][seen], atol=0.01)
        turn = _turn(found.azimuth, expected["azimuth"].to_numpy()[mask]) * np.cos(found.elevation)
        assert turn.max() < 0.01


def test_a_moment_is_read_in_its_own_zone() -> None:
    """The worked example of SPA (appendix A.5: 2003-10-17 12:30:30 at UTC-7): 194.34024 and 90 - 50.11162 degrees.

    Budget 0.01 degrees: it takes 820 mbar and 11 C where we derive 810 mbar and take 12 C.
    """
    place = {"latitude": 39.742476, "longitude": -105.1786, "altitude": 1830.14}
    moment = SunMoment(date="2003-10-17", time="12:30:30", time_zone="Etc/GMT+7", **place)
    azimuth, elevation = angles(moment)
    assert math.degrees(azimuth) == pytest.approx(194.34024, abs=0.01)
    assert math.degrees(elevation) == pytest.approx(90.0 - 50.11162, abs=0.01)


def test_direction_is_the_house_convention() -> None:
    """Azimuth clockwise from north: x east, y north, z up."""
    np.testing.assert_allclose(direction(SunDirection(azimuth=0, elevation=0)), (0, 1, 0), atol=1e-15)
    np.testing.assert_allclose(direction(SunDirection(azimuth=90, elevation=0)), (1, 0, 0), atol=1e-15)
    southwest = (-math.sqrt(0.375), -math.sqrt(0.375), 0.5)
    np.testing.assert_allclose(direction(SunDirection(azimuth=225, elevation=30)), southwest)
    noon = SunMoment(date="2026-06-21", time="12:00", time_zone="UTC", latitude=45.0, longitude=0.0)
    x, y, z = direction(noon)
    assert abs(x) < 0.05
    assert y < 0 < z


def test_a_setting_sun_does_not_jump() -> None:
    """Refraction fades below the horizon instead of stopping: one second moves the sun by less than 0.006 degrees."""
    start = datetime.datetime(2026, 3, 20, 17, 0, tzinfo=datetime.UTC).timestamp()
    found = positions(start + np.arange(9000.0), 45.0, 0.0, 0.0)
    assert found.elevation[0] > 0 > np.radians(-10) > found.elevation[-1]
    steps = np.diff(np.degrees(found.apparent_elevation))
    assert steps.max() < 0
    assert steps.min() > -0.006
    assert found.apparent_elevation[-1] == found.elevation[-1]


@pytest.mark.parametrize(
    ("zone", "latitude", "longitude", "date"),
    [
        ("Europe/Paris", 48.85, 2.35, "2026-06-21"),
        ("Europe/Paris", 48.85, 2.35, "2026-10-25"),
        ("Pacific/Kiritimati", 1.87, -157.4, "2026-02-03"),
        ("America/Los_Angeles", 34.05, -118.24, "2026-12-21"),
        ("Australia/Hobart", -42.88, 147.33, "2026-01-10"),
    ],
)
def test_sunrise_and_sunset_are_those_of_the_local_day(zone: str, latitude: float, longitude: float, date: str) -> None:
    """At both events pvlib has the upper edge on the horizon: 0.005 degrees, which are 20 s where it sets fastest.

    Its own rise and set are right for longitude 0 only: it wraps the event into the day of Greenwich (28 s off in Los
    Angeles, 66 s in Hobart, a whole day in Kiritimati).
    """
    found = day(SunMoment(date=date, time="12:00:00", time_zone=zone, latitude=latitude, longitude=longitude))
    for event, sign in ((found.sunrise, 1.0), (found.sunset, -1.0)):
        assert event is not None
        assert event.date().isoformat() == date
        times = pd.DatetimeIndex([event, event + datetime.timedelta(minutes=1)])
        height = solarposition.get_solarposition(times, latitude, longitude, method="nrel_numpy")["elevation"]
        assert height.iloc[0] == pytest.approx(math.degrees(RISING), abs=0.005)
        assert sign * (height.iloc[1] - height.iloc[0]) > 0


def test_sunrise_at_greenwich_is_pvlibs() -> None:
    """Where pvlib's wrap into the day does no harm, both agree to 20 s (it interpolates three days, we solve)."""
    found = day(SunMoment(date="2026-06-21", time="12:00", time_zone="Europe/London", latitude=51.48, longitude=0.0))
    times = pd.DatetimeIndex([pd.Timestamp("2026-06-21 12:00", tz="Europe/London")])
    expected = solarposition.sun_rise_set_transit_spa(times, 51.48, 0.0)
    assert found.sunrise is not None
    assert found.sunset is not None
    assert abs(found.sunrise.timestamp() - expected["sunrise"].iloc[0].timestamp()) < 20
    assert abs(found.sunset.timestamp() - expected["sunset"].iloc[0].timestamp()) < 20


def test_the_path_agrees_with_the_moment() -> None:
    """A point of the day's path is the sun of that moment, also after the clocks changed."""
    moment = SunMoment(date="2026-10-25", time="12:00:00", time_zone="Europe/Paris", latitude=48.85, longitude=2.35)
    path = day(moment)
    assert path.seconds[-1] == 25 * 3600
    azimuth, elevation = angles(moment)
    assert np.interp(13 * 3600.0, path.seconds, path.elevation) == pytest.approx(elevation, abs=1e-4)
    assert np.interp(13 * 3600.0, path.seconds, path.azimuth) == pytest.approx(azimuth, abs=1e-4)


@pytest.mark.parametrize(("date", "always"), [("2026-06-21", "up"), ("2026-12-21", "down")])
def test_polar_day_and_polar_night(date: str, always: str) -> None:
    """Beyond the circle there are days without sunrise; the day says which kind."""
    found = day(SunMoment(date=date, time="12:00", time_zone="Arctic/Longyearbyen", latitude=78.22, longitude=15.65))
    assert (found.sunrise, found.sunset, found.always) == (None, None, always)


def test_a_direction_has_no_day() -> None:
    """The timeline needs a moment; the answer says so."""
    with pytest.raises(InputError) as refused:
        day(SunDirection())
    assert refused.value.field == "sun.kind"


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"date": "2026-02-29"}, "sun.date"),
        ({"date": "26-1-1"}, "sun.date"),
        ({"date": "1066-10-14"}, "sun.date"),
        ({"time": "25:00:00"}, "sun.time"),
        ({"time": "noon"}, "sun.time"),
        ({"date": "2026-03-29", "time_zone": "Europe/Paris", "time": "02:30:00"}, "sun.time"),
        ({"date": "2026-10-04", "time_zone": "Australia/Lord_Howe", "time": "02:15:00"}, "sun.time"),
        ({"time_zone": "Mars/Olympus"}, "sun.time_zone"),
        ({"time_zone": "../../etc/passwd"}, "sun.time_zone"),
        ({"latitude": 91}, "sun.latitude"),
        ({"longitude": float("nan")}, "sun.longitude"),
        ({"altitude": 1e6}, "sun.altitude"),
    ],
)
def test_moments_that_do_not_exist_are_refused(changes: dict[str, Any], field: str) -> None:
    """Calendars, clocks that skip an hour and unknown zones are named, not guessed at."""
    with pytest.raises(InvalidDocument) as refused:
        validate(SceneState, {"sun": {"kind": "moment", **changes}})
    assert refused.value.errors[0].field == field


def test_the_earlier_of_two_equal_times_is_meant() -> None:
    """When the clocks go back, 02:30 happens twice; it is read as summer time."""
    twice = SunMoment(date="2026-10-25", time="02:30:00", time_zone="Europe/Paris")
    assert suns.moment(twice).utcoffset() == datetime.timedelta(hours=2)


def test_every_known_zone_can_be_opened() -> None:
    """What validation lets through, the calendar can use."""
    assert "Europe/Paris" in suns.time_zones()
    for name in sorted(suns.time_zones())[::25]:
        zoneinfo.ZoneInfo(name)
