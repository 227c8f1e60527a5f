"""Weather systems: cover by latitude, seams, and the map round a site."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.clouds import weather
from renderer.clouds.planet import Layer, Planet


@pytest.fixture(scope="module")
def earth() -> np.ndarray:
    return weather.systems(np.random.default_rng(11))


def test_subtropics_are_clearer_than_storm_tracks(earth: np.ndarray) -> None:
    def band(low: float, high: float) -> float:
        rows = (np.array([low, high]) + 90) / 180 * weather.ROWS
        return float(earth[int(rows[0]) : int(rows[1])].mean())

    assert earth.min() >= 0
    assert earth.max() <= 1
    assert band(15, 30) < 0.6 * band(50, 65)
    assert band(-30, -15) < 0.6 * band(-65, -45)


def test_the_date_line_is_no_seam(earth: np.ndarray) -> None:
    across = np.abs(earth[:, 0] - earth[:, -1]).mean()
    assert across < 1.3 * np.abs(np.diff(earth, axis=1)).mean()


def test_a_place_is_found_on_the_map_round_a_site() -> None:
    """A spot 20 degrees east of a site on the equator lies at sin(10 degrees) of the way to the right."""
    spot = np.zeros((weather.ROWS, weather.COLUMNS), np.float32)
    row, column = weather.ROWS // 2, int((60 + 180) / 360 * weather.COLUMNS)
    spot[row - 3 : row + 3, column - 3 : column + 3] = 1
    found = weather.round_site(spot, 0.0, 40.0, 6.35e6)
    far = found.copy()
    middle = weather.ROUND_SITE // 2
    far[middle - 60 : middle + 60, middle - 60 : middle + 60] = 0  # the site's own closed sky
    y, x = np.unravel_index(far.argmax(), far.shape)
    assert (x + 0.5) / middle - 1 == pytest.approx(np.sin(np.radians(10)), abs=0.02)
    assert (y + 0.5) / middle - 1 == pytest.approx(0, abs=0.02)
    assert found[middle, middle] > 0.99, "the sky is closed over the site"


def test_the_layer_ends_at_its_front_and_nowhere_else(earth: np.ndarray) -> None:
    """West of 200 km there is none of it; without a front the weather is as it was."""
    planet = Planet(latitude=10.0, longitude=20.0)
    sky = weather.round_site(earth, 10.0, 20.0, planet.radius)
    assert weather.layer_round_site(earth, planet, Layer()) is sky
    ended = weather.layer_round_site(earth, planet, Layer(ends=2.0e5, ends_azimuth=270.0))
    even = weather.layer_round_site(np.ones((4, 4), np.float32), planet, Layer(ends=2.0e5, ends_azimuth=270.0))
    middle = weather.ROUND_SITE // 2
    west = (middle - 0.5 - np.arange(middle)) / middle * 2 * planet.radius  # m, nearly, along the parallel of the site
    row, near = even[middle, :middle], west < 1.0e6
    assert row[near & (west > 2.0e5 + weather.FRONT)].max() == 0
    assert row[near & (west < 2.0e5 - weather.FRONT)].min() == 1
    assert np.interp(2.0e5, west[::-1], row[::-1]) == pytest.approx(0.5, abs=0.1)
    assert even[middle, middle:].min() == 1, "it goes on to the east"
    assert ended == pytest.approx(even * sky)


def test_the_front_lies_where_its_azimuth_says() -> None:
    planet, even = Planet(), np.ones((4, 4), np.float32)
    found = weather.layer_round_site(even, planet, Layer(ends=1.0e6, ends_azimuth=0.0))
    middle = weather.ROUND_SITE // 2
    assert found[-200, middle] == 0
    assert found[200, middle] == found[middle, 200] == found[middle, -200] == 1
