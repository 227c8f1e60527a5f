"""The sky: quadrature, energy, colours, the picture against a photon count, and GLSL against its twin."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from renderer.core.errors import Cancelled, InvalidDocument
from renderer.gl.probe import probe
from renderer.gl.thread import GL, GLThread
from renderer.world import sky
from renderer.world.sky import (
    NIGHT_RADIANCE,
    SKY_DECLARATIONS,
    SOLAR_CONSTANT,
    SkyNow,
    bake_sky,
    irradiance_weights,
    metered_light,
    mie_phase,
    rayleigh_phase,
    sky_for,
    sky_radiance,
    sky_uniforms,
    view_directions,
    visible_share,
)
from renderer.world.sun import ANGULAR_RADIUS, SunDirection, direction
from tests.world.test_atmosphere import photons

Tables = dict[str, np.ndarray]


def _quiet(_fraction: float, _words: str) -> None:
    """Progress nobody watches."""


@pytest.fixture(scope="module")
def tables() -> Tables:
    """The default sky."""
    return bake_sky({}, {}, _quiet)


@pytest.fixture(scope="module")
def gl() -> Iterator[GLThread]:
    """A context of this module's own."""
    thread = GLThread()
    yield thread
    thread.close()


def _at(tables: Tables, degrees: float) -> SkyNow:
    return sky_for(tables, math.radians(degrees))


def test_a_sky_of_radiance_one_gives_pi() -> None:
    """The weights are exact for constants, and to 1e-3 for a smooth sky: radiance sin(e) gives 2 pi / 3."""
    weights = irradiance_weights()
    assert weights.sum() == pytest.approx(math.pi, rel=1e-12)
    elevations, _ = view_directions()
    assert (weights * np.sin(elevations)[:, None]).sum() == pytest.approx(2.0 * math.pi / 3.0, rel=1e-3)


@pytest.mark.parametrize(("degrees", "share"), [(90.0, 1.0), (30.0, 0.5), (0.0, 0.0), (-5.0, 0.0)])
def test_the_meter_lies_level(tables: Tables, degrees: float, share: float) -> None:
    """A beam counts by its sine, and not at all from below; the sky comes on top; green weighs most."""
    white = {**tables, "sun_irradiance": np.full_like(tables["sun_irradiance"], 100.0)}
    white["sky_irradiance"] = np.full_like(tables["sky_irradiance"], 7.0)
    assert metered_light(white, math.radians(degrees)) == pytest.approx(100.0 * share + 7.0)
    green = {**white, "sun_irradiance": white["sun_irradiance"] * [0.0, 1.0, 0.0]}
    assert metered_light(green, math.radians(degrees)) == pytest.approx(71.52 * share + 7.0)


def test_there_is_light_at_night_and_more_with_every_degree(tables: Tables) -> None:
    """The meter never reads nothing, of which there is no logarithm, and never falls while the sun rises."""
    read = [metered_light(tables, math.radians(degrees)) for degrees in range(-90, 91)]
    assert read[0] > 0
    assert np.all(np.diff(read) >= 0)
    assert read[-1] == pytest.approx(1300, rel=0.05)


@pytest.mark.parametrize("phase", [rayleigh_phase, mie_phase])
def test_phase_functions_integrate_to_one(phase: Any) -> None:
    """Over the sphere, per steradian."""
    x, w = np.polynomial.legendre.leggauss(64)
    assert 2.0 * math.pi * np.sum(w * phase(x)) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("degrees", [60.0, 7.3, -0.1, -5.0])
def test_irradiance_is_the_integral_of_the_picture(tables: Tables, degrees: float) -> None:
    """What lights the ground is what is seen: a quadrature of `sky_radiance` over the dome, to 2e-3 (its kinks)."""
    now, sun = _at(tables, degrees), direction(SunDirection(azimuth=123.0, elevation=degrees))
    x, w = np.polynomial.legendre.leggauss(160)
    elevation, azimuth = 0.25 * np.pi * (x + 1.0), np.pi * (x + 1.0)
    e, a = np.meshgrid(elevation, azimuth, indexing="ij")
    d = np.stack([np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)], axis=-1)
    measure = (0.25 * np.pi * w * np.sin(elevation) * np.cos(elevation))[:, None] * (np.pi * w)[None, :]
    found = np.einsum("eac,ea->c", sky_radiance(now, sun, d), measure)
    np.testing.assert_allclose(found, now.sky_irradiance, rtol=2e-3)


def test_the_ground_gets_no_more_than_the_sun_sends(tables: Tables) -> None:
    """From 5 degrees up; below, a round Earth's sky is lit from beyond the horizon. At noon most of it arrives."""
    for degrees in (5.0, 10.0, 25.0, 45.0, 70.0, 90.0):
        now = _at(tables, degrees)
        share = (now.sun_irradiance * math.sin(math.radians(degrees)) + now.sky_irradiance) / (
            SOLAR_CONSTANT * math.sin(math.radians(degrees))
        )
        assert (share < 1.0).all()
        assert degrees < 45.0 or (share > 0.8).all()


@pytest.mark.parametrize("band", [0, 1, 2])
def test_skylight_agrees_with_traced_photons(tables: Tables, band: int) -> None:
    """At 45 degrees, all orders, 0.15 ground: within 4 %.

    Isotropic higher orders 2 %, the photons' flat Earth, their noise, and segments with tables under 1 % each.
    """
    sine = math.sin(math.radians(45.0))
    found = _at(tables, 45.0).sky_irradiance[band] / SOLAR_CONSTANT
    assert found == pytest.approx(photons(band, sine, 0.15, 200_000), rel=0.04)


def test_photons_reject_a_sky_without_multiple_scattering() -> None:
    """The same measure calls a singly scattered blue sky wrong, by more than five times its budget."""
    air = dataclasses.replace(sky.atmosphere.breathe(sky.Atmosphere(), ANGULAR_RADIUS), glow=np.zeros((24, 49, 3)))
    sun = np.array([math.radians(45.0)])
    once = np.stack([sky._view_row(air, 6360.001, float(e), sun)[0] for e in view_directions()[0]])
    found = float(np.sum(once[..., 2] * irradiance_weights()))
    assert found < 0.8 * photons(2, math.sin(math.radians(45.0)), 0.15, 50_000)


def test_segments_of_a_ray_are_many_enough(tables: Tables, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten times as many change the horizon and the zenith by less than 2 %, also with the sun on the horizon."""
    air = sky.atmosphere.breathe(sky.Atmosphere(), ANGULAR_RADIUS)
    suns = np.radians([-2.0, 0.0, 3.0, 30.0])
    few = [sky._view_row(air, 6360.001, e, suns) for e in (0.0, 0.1, 1.2)]
    monkeypatch.setattr(sky, "STEPS", 400)
    many = [sky._view_row(air, 6360.001, e, suns) for e in (0.0, 0.1, 1.2)]
    for coarse, fine in zip(few, many, strict=True):
        np.testing.assert_allclose(coarse, fine, rtol=0.02, atol=1e-6)


def test_colours_of_the_day(tables: Tables) -> None:
    """Blue zenith, white-hot sun at noon, red sun and red horizon at sunset."""
    noon, evening = _at(tables, 60.0), _at(tables, 1.0)
    zenith = noon.view[-1, 0]
    assert zenith[2] > 2.0 * zenith[0]
    assert noon.sun_irradiance[2] > 0.7 * noon.sun_irradiance[0]
    assert evening.sun_irradiance[2] < 0.1 * evening.sun_irradiance[0]
    horizon = evening.view[3, 0]
    assert horizon[0] > horizon[1] > horizon[2]


def test_light_is_finite_from_night_to_zenith(tables: Tables) -> None:
    """No NaN and nothing negative at any elevation, tables' ends included; night is dark, but not black."""
    for degrees in np.linspace(-90.0, 90.0, 361):
        now = _at(tables, float(degrees))
        for values in (now.sun_irradiance, now.sky_irradiance, now.view, now.disc_radiance):
            assert np.isfinite(values).all()
            assert (values >= 0.0).all()
    night, noon = _at(tables, -18.0), _at(tables, 60.0)
    assert (night.sun_irradiance == 0.0).all()
    assert (night.sky_irradiance < 1e-5 * noon.sky_irradiance).all()
    assert (night.sky_irradiance >= 0.999 * math.pi * NIGHT_RADIANCE).all()


def test_light_changes_without_steps(tables: Tables) -> None:
    """A hundredth of a degree never changes the whole light by more than 4 %: the disc sets over half a degree."""
    degrees = np.arange(-18.0, 20.0, 0.01)
    light = np.array(
        [
            now.sky_irradiance[0] + now.sun_irradiance[0] * max(0.0, math.sin(math.radians(d)))
            for d in degrees
            for now in [_at(tables, float(d))]
        ]
    )
    assert np.abs(np.diff(light) / light[:-1]).max() < 0.04
    sun = np.array([_at(tables, float(d)).sun_irradiance[1] for d in np.arange(-1.0, 90.0, 0.25)])
    assert (np.diff(sun) >= 0.0).all()


def test_the_disc_holds_the_suns_irradiance(tables: Tables) -> None:
    """Radiance times solid angle is irradiance; a set sun has no disc; half of one shows at elevation zero."""
    now = _at(tables, 40.0)
    np.testing.assert_allclose(now.disc_radiance * math.pi * ANGULAR_RADIUS**2, now.sun_irradiance, rtol=1e-9)
    assert (_at(tables, -0.5).disc_radiance == 0.0).all()
    assert [visible_share(e * ANGULAR_RADIUS) for e in (-2.0, 0.0, 2.0)] == pytest.approx([0.0, 0.5, 1.0])


def test_haze_whitens_the_sky_and_dims_the_sun(tables: Tables) -> None:
    """The air's parameters reach the bake."""
    thick = bake_sky({"haze": 20.0}, {}, _quiet)
    clear, hazy = _at(tables, 45.0), _at(thick, 45.0)
    assert (hazy.sun_irradiance < 0.9 * clear.sun_irradiance).all()
    assert hazy.view[-1, 0, 2] / hazy.view[-1, 0, 0] < clear.view[-1, 0, 2] / clear.view[-1, 0, 0]


def test_a_bake_can_be_cancelled_and_refuses_nonsense() -> None:
    """Cancellation comes through the progress call; arguments are checked like any document."""

    def cancel(fraction: float, _words: str) -> None:
        if fraction > 0.0:
            raise Cancelled("no longer wanted")

    with pytest.raises(Cancelled):
        bake_sky({}, {}, cancel)
    with pytest.raises(InvalidDocument):
        bake_sky({"haze": -1.0}, {}, _quiet)


def _sky_in_glsl(thread: GLThread, now: SkyNow, sun: np.ndarray, directions: np.ndarray, body: str) -> np.ndarray:
    def run(gl: GL) -> np.ndarray:
        view = gl.texture2d(now.view)
        try:
            return probe(
                gl,
                ["lib/sky.glsl"],
                body,
                {"d": directions.astype(np.float32)},
                3,
                declarations=SKY_DECLARATIONS,
                uniforms=sky_uniforms(now, sun),
                textures={"sky_view": view},
            )
        finally:
            view.release()

    return np.asarray(thread.call(run))


def test_glsl_agrees_with_the_twin(tables: Tables, gl: GLThread) -> None:
    """To 0.5 % of each value: llvmpipe's asin and acos are good to 1e-4 rad, its filter to 1/256 of a texel."""
    now, sun = _at(tables, 12.0), direction(SunDirection(azimuth=200.0, elevation=12.0))
    random = np.random.default_rng(3)
    d = random.normal(size=(2000, 3))
    d = np.concatenate([d / np.linalg.norm(d, axis=1, keepdims=True), [[0, 0, 1], [0, 0, -1], [0, 1, 0]]])
    expected = sky_radiance(now, sun, d)
    found = _sky_in_glsl(gl, now, sun, d, "sky_radiance(d)")
    np.testing.assert_allclose(found, expected, rtol=5e-3)
    mirrored = _sky_in_glsl(gl, now, sun, d, "sky_radiance(vec3(d.y, d.x, d.z))")
    assert np.abs(mirrored / expected - 1.0).max() > 0.1  # the same measure rejects swapped axes


def test_the_disc_in_glsl_is_as_wide_as_the_sun(tables: Tables, gl: GLThread) -> None:
    """Directions at 0.97 and 1.03 radii from its centre fall inside and outside."""
    now, sun = _at(tables, 30.0), direction(SunDirection(azimuth=77.0, elevation=30.0))
    side = np.cross(sun, (0.0, 0.0, 1.0)) / np.linalg.norm(np.cross(sun, (0.0, 0.0, 1.0)))
    d = np.array(
        [np.cos(a) * sun + np.sin(a) * side for a in ANGULAR_RADIUS * np.array([0.0, 0.97, 1.03, -0.97, -1.03])]
    )
    found = _sky_in_glsl(gl, now, sun, d, "sky_sun_disc(d)")
    np.testing.assert_allclose(found[[0, 1, 3]], np.broadcast_to(now.disc_radiance, (3, 3)), rtol=1e-6)
    assert (found[[2, 4]] == 0.0).all()


@pytest.mark.parametrize("elevation", [4.0, 35.0])
def test_cells_of_one_solid_angle_send_the_whole_light_of_the_sky(tables: Tables, elevation: float) -> None:
    sun = np.array([np.cos(np.radians(elevation)), 0.0, np.sin(np.radians(elevation))])  # in the east
    now = sky_for(tables, math.radians(elevation))
    cells = sky.sky_cells(now, sun)
    assert cells.shape == (*sky.CELLS, 3)
    sine = (np.arange(sky.CELLS[0]) + 0.5) / sky.CELLS[0]
    level = 2 * np.pi * (sine[:, None] * cells.mean(axis=1)).mean(axis=0)
    assert level == pytest.approx(now.sky_irradiance, rel=4e-3)
    quarters = cells[: sky.CELLS[0] // 4].reshape(-1, 4, sky.CELLS[1] // 4, 3).mean(axis=(0, 2, 3))
    assert quarters[:2].sum() > 1.02 * quarters[2:].sum(), "columns run clockwise from north"
