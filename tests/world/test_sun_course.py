"""The suns of a stretch of time: when they stand, what they send, and their sums."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pvlib
import pytest

from renderer.core.errors import InputError, InvalidDocument, LimitError
from renderer.core.params import validate
from renderer.world.sun_course import BINS, Place, SunlightPeriod, clear_sky, course, instants

GRENOBLE = Place(45.2, 5.7, 0.0, (200.0, 1400.0))
YEAR = SunlightPeriod(start="2024-01-01", end="2024-12-31", minutes=30)


@pytest.mark.parametrize(
    ("start", "end", "zone", "hours"),
    [
        ("2024-02-28", "2024-03-01", "UTC", 72),
        ("2023-02-28", "2023-03-01", "UTC", 48),
        ("2024-03-31", "2024-03-31", "Europe/Paris", 23),
        ("2024-10-27", "2024-10-27", "Europe/Paris", 25),
        ("2024-04-07", "2024-04-07", "Australia/Lord_Howe", 24.5),
    ],
)
def test_days_have_their_true_length(start: str, end: str, zone: str, hours: float) -> None:
    times, lengths = instants(SunlightPeriod(start=start, end=end, time_zone=zone, minutes=60))
    assert lengths.sum() == pytest.approx(hours)
    assert np.all(np.diff(times) > 0)
    assert times[0] == pytest.approx(pd.Timestamp(start, tz=zone).timestamp() + 1800)


def test_the_year_has_the_hours_that_pvlib_counts() -> None:
    times = pd.date_range("2024-01-01 00:15", "2024-12-31 23:45", freq="30min", tz="UTC")
    seen = pvlib.solarposition.get_solarposition(times, 45.2, 5.7, altitude=800.0)["apparent_elevation"]
    assert course(YEAR, GRENOBLE).hours == pytest.approx(0.5 * (seen > 0).sum(), abs=2.0)


def test_a_day_on_the_equator_is_half_of_it() -> None:
    """And the seven minutes that refraction adds."""
    found = course(SunlightPeriod(start="2024-03-20", end="2024-03-20", minutes=1), Place(0.0, 0.0, 0.0, (0.0, 0.0)))
    assert found.hours == pytest.approx(12 + 4 * 2 * 0.5667 / 60, abs=0.04)


def test_a_bin_sums_its_suns_from_each_on() -> None:
    found = course(SunlightPeriod(start="2024-06-01", end="2024-06-20"), GRENOBLE)
    for b in range(0, len(found.azimuths), 17):
        first, last = found.firsts[b], found.firsts[b + 1]
        sums = found.sums[first + b : last + b + 1]
        assert np.all(np.diff(found.tangents[first:last]) >= 0)
        np.testing.assert_allclose(sums[:, 0], 0.25 * np.arange(last - first, -1, -1))
        # What faces the bin's azimuth receives all that is sent from it, but for the bin's width.
        towards = np.sin(found.azimuths[b]) * sums[:, 1] + np.cos(found.azimuths[b]) * sums[:, 2]
        np.testing.assert_allclose(towards, np.hypot(sums[:, 1], sums[:, 2]), rtol=(np.pi / BINS) ** 2)


def test_the_grid_s_bearing_turns_the_suns() -> None:
    turned = Place(45.2, 5.7, 2 * np.pi / BINS * 3, (200.0, 1400.0))
    straight, found = course(YEAR, GRENOBLE), course(YEAR, turned)
    np.testing.assert_allclose(found.azimuths, straight.azimuths - turned.bearing)


def test_thin_air_high_up_lets_more_through() -> None:
    found = course(YEAR, GRENOBLE)
    everything = found.sums[found.firsts[:-1] + np.arange(len(found.azimuths))].sum(axis=0)
    assert everything[6] > 1.05 * everything[3]
    assert 0.7 * found.diffuse[0] < found.diffuse[1] < 1.1 * found.diffuse[0]


def test_no_sun_rises_in_the_polar_night() -> None:
    found = course(SunlightPeriod(start="2024-12-10", end="2024-12-20"), Place(80.0, 0.0, 0.0, (0.0, 0.0)))
    assert (found.hours, len(found.azimuths), found.diffuse.sum()) == (0.0, 0, 0.0)


def test_the_clear_sky_is_near_another_model_s() -> None:
    """Haurwitz 1945 knows the zenith angle alone; over low land and haze of 3 the two agree but for the lowest suns."""
    elevation = np.radians([30.0, 45.0, 60.0, 75.0])
    beam, diffuse = clear_sky(np.full(4, 1.711e9), elevation, 100.0, 3.0)
    level = beam * np.sin(elevation) + diffuse
    other = pvlib.clearsky.haurwitz(pd.Series(90 - np.degrees(elevation)))["ghi"].to_numpy()
    np.testing.assert_allclose(level, other, rtol=0.05)


@pytest.mark.parametrize(
    ("document", "field"),
    [
        ({"start": "2023-02-29"}, "start"),
        ({"end": "yesterday"}, "end"),
        ({"end": "1500-01-01"}, "end"),
        ({"minutes": 0}, "minutes"),
        ({"minutes": 7.5}, "minutes"),
        ({"time_zone": "Europe/Atlantis"}, "time_zone"),
        ({"latitude": 91}, "latitude"),
        ({"latitude": True}, "latitude"),
        ({"receiver": "moon"}, "receiver"),
        ({"turbidity": 0}, "turbidity"),
        ({"from": "2024-01-01"}, "from"),
    ],
)
def test_a_wrong_argument_is_named(document: dict[str, object], field: str) -> None:
    with pytest.raises(InvalidDocument) as refused:
        validate(SunlightPeriod, document)
    assert [error.field for error in refused.value.errors] == [field]


def test_a_range_must_be_one_and_not_too_long() -> None:
    with pytest.raises(InputError, match="before the first day") as refused:
        instants(SunlightPeriod(start="2024-05-02", end="2024-05-01"))
    assert refused.value.field == "end"
    with pytest.raises(LimitError, match="shorter range"):
        instants(SunlightPeriod(start="2000-01-01", end="2010-12-31"))
