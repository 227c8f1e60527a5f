"""Hours of sun and irradiation of a land: closed forms, then the brute force of one ray for each sun and point."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pvlib
import pytest

from renderer.core.errors import Cancelled
from renderer.reference.horizon import horizon
from renderer.world.sun_course import Place, SunlightPeriod, course
from renderer.world.sunlight import Light
from renderer.world.sunlight_kernels import pyramid, sky_of
from renderer.world.terrain import crop, default_terrain, normals

PLACE = Place(36.5, -84.0, 0.0, (0.0, 1000.0))
CELL = (20.0, 20.0)
YEAR = SunlightPeriod(start="2024-01-01", end="2024-12-31", minutes=15)
MONTH = SunlightPeriod(start="2024-02-01", end="2024-02-29", minutes=15)


def light_of(surface: np.ndarray, period: SunlightPeriod = MONTH, cell: tuple[float, float] = CELL) -> Light:
    heights = surface.astype(np.float32)
    return Light(heights, heights, cell, course(period, PLACE), PLACE.altitudes, "ground")


def rough(size: int, relief: float, roughness: float) -> np.ndarray:
    """A fractal land: noise of spectrum |k|^-roughness, of a standard deviation of `relief` metres."""
    noise = np.fft.rfft2(np.random.Generator(np.random.PCG64(5)).standard_normal((size, size)))
    scale = np.hypot(np.fft.fftfreq(size)[:, None], np.fft.rfftfreq(size)[None])
    scale[0, 0] = np.inf
    land = np.fft.irfft2(noise * scale**-roughness, (size, size))
    return (land * (relief / land.std()) + 500).astype(np.float32)


def test_a_plain_has_all_there_is() -> None:
    light = light_of(np.full((6, 7), 500.0))
    hours, beam, diffuse, sky = light.at(np.array([[3, 3], [0, 6]])).T
    suns = light.suns
    everything = suns.sums[suns.firsts[:-1] + np.arange(len(suns.azimuths))].sum(axis=0)
    np.testing.assert_allclose(hours, suns.hours)
    np.testing.assert_allclose(sky, 1.0)
    np.testing.assert_allclose(diffuse, suns.diffuse.mean(), rtol=1e-6)
    np.testing.assert_allclose(beam, (everything[3] + everything[6]) / 2, rtol=1e-6)


def test_a_wall_to_the_south_hides_what_it_must() -> None:
    """Along azimuth a, a long wall of height H at distance d has the slope H |cos a| / d."""
    land = np.zeros((60, 801))
    land[20] = 150.0
    light = light_of(land)
    suns = light.suns
    # The bilinear wall's foot begins a cell before its crest, but no line of it rises over the crest's own.
    slope = np.where(np.cos(suns.azimuths) < 0, 150.0 * -np.cos(suns.azimuths) / (8 * CELL[1]), 0.0)
    bins = np.repeat(np.arange(len(suns.azimuths)), np.diff(suns.firsts))
    expected = 0.25 * (suns.tangents > slope[bins]).sum()
    (found,) = light.at(np.array([[12, 400]]))
    assert found[0] == pytest.approx(expected, abs=0.25)
    assert 0 < expected < 0.8 * suns.hours


@pytest.mark.parametrize("degrees", [10.0, 30.0, 60.0])
def test_a_slope_sees_its_share_of_the_sky(degrees: float) -> None:
    """(1 + cos S) / 2 of it (Liu and Jordan 1963), and the grid's end is far."""
    slope = np.tan(np.radians(degrees))
    land = np.broadcast_to(np.arange(401)[::-1] * CELL[0] * slope, (401, 401))
    (found,) = light_of(land).at(np.array([[200, 200]]))
    assert found[3] == pytest.approx((1 + np.cos(np.radians(degrees))) / 2, abs=2e-3)


def test_the_sky_of_a_pit_and_of_a_slope() -> None:
    assert sky_of(1.0, 1.0, 0.0) == pytest.approx(0.5)  # a pit with walls of 45 degrees: cos^2
    assert sky_of(0.0, 0.0, 1.0) == pytest.approx(
        np.pi / 2
    )  # an upright wall, ahead: pi / 2 of it over half the circle


@pytest.mark.parametrize("shape", [(2, 2), (3, 2), (5, 9), (33, 17), (64, 65)])
def test_the_pyramid_holds_the_highest_points(shape: tuple[int, int]) -> None:
    land = np.random.Generator(np.random.PCG64(1)).random(shape).astype(np.float32)
    tops, starts, widths = pyramid(land)
    for level in range(len(widths)):
        side = 1 << level
        for i in range(0, shape[0] - 1, side):
            for j in range(0, shape[1] - 1, side):
                top = tops[starts[level] + (i >> level) * widths[level] + (j >> level)]
                assert top == land[i : i + side + 1, j : j + side + 1].max()


class Brute:
    """Every sun of a range by pvlib, and a ray for each at each point."""

    def __init__(self, first: str, last: str) -> None:
        times = pd.date_range(f"{first} 00:07:30", f"{last} 23:52:30", freq="15min", tz="UTC")
        suns = pvlib.solarposition.get_solarposition(times, PLACE.latitude, PLACE.longitude, altitude=500.0)
        suns = suns[suns["apparent_elevation"] > 0]
        self.azimuth = np.radians(suns["azimuth"].to_numpy())
        self.elevation = np.radians(suns["apparent_elevation"].to_numpy())
        mass = pvlib.atmosphere.get_relative_airmass(suns["apparent_zenith"])
        extra = pvlib.irradiance.get_extra_radiation(suns.index.day_of_year.to_numpy())
        self.sent = []
        for altitude in PLACE.altitudes:
            absolute = pvlib.atmosphere.get_absolute_airmass(mass, pvlib.atmosphere.alt2pres(altitude))
            sent = pvlib.clearsky.ineichen(suns["apparent_zenith"], absolute, 3.0, altitude, extra).fillna(0.0)
            self.sent.append(sent[["dni", "dhi"]].to_numpy())

    def at(self, land: np.ndarray, cell: tuple[float, float], point: np.ndarray) -> tuple[float, float, float]:
        """Hours, beam and diffuse irradiation of one point."""
        angle, _ = horizon(land, cell, point[None], self.azimuth)
        seen = self.elevation > angle[0]
        normal = normals(land, cell)[point[0], point[1]]
        flat = np.cos(self.elevation)
        cosine = normal @ [np.sin(self.azimuth) * flat, np.cos(self.azimuth) * flat, np.sin(self.elevation)]
        share = land[point[0], point[1]] / 1000.0
        beam, diffuse = ((1 - share) * self.sent[0] + share * self.sent[1]).T / 4000
        sky = self.sky(land, cell, point, normal)
        return 0.25 * seen.sum(), (beam * np.maximum(cosine, 0) * seen).sum(), diffuse.sum() * sky

    @staticmethod
    def sky(land: np.ndarray, cell: tuple[float, float], point: np.ndarray, normal: np.ndarray) -> float:
        """Share of an even sky, summed over small patches above the horizon."""
        azimuths = (np.arange(360) + 0.5) * np.pi / 180
        angle, _ = horizon(land, cell, point[None], azimuths)
        height = (np.arange(720) + 0.5) * np.pi / 1440
        flat, up = np.cos(height), np.sin(height)
        across = normal[0] * np.sin(azimuths) + normal[1] * np.cos(azimuths)
        cosine = across[:, None] * flat + normal[2] * up
        patches = np.maximum(cosine, 0) * flat * (height > angle[0][:, None])
        return float(patches.sum() * (np.pi / 180) * (np.pi / 1440) / np.pi)


LANDS = {
    "real": (lambda: crop(default_terrain(), (2656.0, -9312.0), 256 * 20.0, 20.0).elevation, CELL, YEAR),
    "rough": (lambda: rough(256, 120.0, 1.9), CELL, MONTH),
    "oblong cells": (lambda: rough(257, 100.0, 2.2)[:, :200], (20.0, 30.0), MONTH),
}


def errors(name: str, spoil: bool = False) -> np.ndarray:
    """Relative errors of hours, beam and diffuse irradiation at 50 points, (50, 3)."""
    make, cell, period = LANDS[name]
    land = make()
    chance = np.random.Generator(np.random.PCG64(11))
    points = np.stack([chance.integers(0, side, 50) for side in land.shape], axis=1)
    light = light_of(land, period, cell)
    if spoil:
        light = replace(light, suns=replace(light.suns, azimuths=light.suns.azimuths + np.pi))
    brute = Brute(period.start, period.end)
    truth = np.array([brute.at(land, cell, point) for point in points])
    return light.at(points)[:, :3] / truth - 1


BUDGET = {
    "hours": 0.015,  # bins of one degree: 0.1 % of a year, 1 % of a month in a steep hollow
    "beam": 0.015,  # the same
    "diffuse": 0.006,  # 16 azimuths
}


@pytest.mark.parametrize("name", LANDS)
def test_fifty_points_against_brute_force(name: str) -> None:
    worst = np.abs(errors(name)).max(axis=0)
    assert dict(zip(BUDGET, worst < list(BUDGET.values()), strict=True)) == dict.fromkeys(BUDGET, True), worst


def test_azimuths_from_the_south_are_found_out() -> None:
    assert np.abs(errors("rough", spoil=True)).max(axis=0)[0] > 0.02


def test_trees_shade_the_ground_and_stand_in_the_sun_themselves() -> None:
    ground = np.full((40, 40), 500.0, np.float32)
    surface = ground.copy()
    surface[:20] += 20.0  # a stand over the northern half
    surface[30:] += 20.0  # and one to the south
    light = replace(light_of(ground), surface=surface)
    nodes = np.array([[10, 20], [28, 20], [22, 20]])
    stand, shaded, open_ = light.at(nodes)
    assert np.all(np.isnan(stand))
    assert 0 < shaded[0] < open_[0] < light.suns.hours
    top = replace(light, receiver="canopy").at(nodes)
    assert top[0, 0] == pytest.approx(light.suns.hours)
    np.testing.assert_array_equal(top[1:], [shaded, open_])
    bare = replace(light, receiver="bare_ground").at(nodes)
    np.testing.assert_allclose(bare[:, 0], light.suns.hours)


def test_work_that_nobody_wants_stops() -> None:
    def stop(share: float, words: str) -> None:
        raise Cancelled("enough")

    light = light_of(rough(128, 50.0, 2.0), SunlightPeriod(start="2024-02-01", end="2024-02-01"))
    with pytest.raises(Cancelled):
        light.at(np.stack(np.indices((128, 128)).reshape(2, -1), axis=1), stop)
