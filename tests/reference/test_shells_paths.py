"""Paths of light through matter that scatters within itself: closed forms, DISORT's slabs, Mitsuba's picture."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.reference.shells import Options, render
from renderer.reference.shells_world import ShellsWorld, Surface
from tests.reference.shells import CENTRE, alpha, beams, slab, volume, volume_camera

pytestmark = pytest.mark.slow

EVEN = (math.pi,) * 3
"""Irradiance of a sky of radiance 1."""

MITSUBA = np.array([
    [0.30000, 0.30000, 0.30000, 0.30008, 0.30000, 0.30000, 0.30000, 0.30000],
    [0.30000, 0.30000, 0.30000, 0.36936, 0.32020, 0.30590, 0.30000, 0.30000],
    [0.30000, 0.30000, 0.30795, 0.30082, 0.30319, 0.31263, 0.34514, 0.31525],
    [0.30001, 0.33140, 0.31484, 0.31265, 0.32335, 0.31689, 0.31821, 0.30841],
    [0.30126, 0.36289, 0.36507, 0.44584, 0.33840, 0.37443, 0.31842, 0.30000],
    [0.30000, 0.33096, 0.35071, 0.45546, 0.38400, 0.31142, 0.31549, 0.30000],
    [0.30000, 0.30000, 0.30005, 0.31253, 0.30053, 0.30000, 0.30000, 0.30000],
    [0.30000, 0.30000, 0.30000, 0.30000, 0.30000, 0.30000, 0.30000, 0.30000],
])  # fmt: skip
"""Mean radiance of blocks of 16 x 16 pixels, from `d_mitsuba_scatter_128.npz` of the shared references: albedo 0.99,
Henyey and Greenstein's g = 0.6, at most 100 orders, before a background of 0.3."""


def layer(tau: float, g: float, albedo: float = 1.0, **changes: object) -> ShellsWorld:
    """An even slab one metre thick, as good as endless."""
    return slab([albedo] * 3 + [alpha(tau, 0.1)], 0.1, sides=(2000.0, 2000.0, 1.0), origin=(-1000.0, -1000.0, 0.0),
                light="scattering", asymmetry=g, **changes)  # fmt: skip


def down(mu: float) -> tuple[float, float, float]:
    return math.sqrt(1 - mu * mu), 0.0, -mu


@pytest.mark.parametrize(("tau", "mu", "right"), [(0.5, 1.0, 0.01993), (2.0, 0.7, 0.17726), (2.0, 0.1, 0.61569)])
def test_slabs_reflect_what_disort_says(tau: float, mu: float, right: float) -> None:
    """By reciprocity a view under an even sky sees what a slab reflects of a beam that comes the same way."""
    found = render(layer(tau, 0.85, e_sky=EVEN), beams(np.tile([0.3, 0.4, 3.0], (64, 1)), down(mu)), CENTRE,
                   Options(paths=1500))  # fmt: skip
    error = float(np.sqrt((found.standard_error**2).sum())) / 64
    assert error < 0.02 * right + 2e-4
    assert abs(found.radiance[0, :, 0].mean() - right) < 3.5 * error
    assert found.radiance[0, 0, 3] == pytest.approx(-math.expm1(-tau / mu))


def test_the_first_order_is_in_closed_form() -> None:
    tau, g, mu = 1.2, 0.4, 0.8
    sun = (-0.6, 0.0, 0.8)
    world = layer(tau, g, 0.7, sun=sun, e_sun=(3.0, 3.0, 3.0))
    lobe = (1 - g * g) / (4 * math.pi) / (1 + g * g - 2 * g * -mu) ** 1.5
    right = 0.7 * 3.0 * lobe * mu / (1 + mu) * -math.expm1(-tau * (1 + 1 / mu))
    once, all_orders = (
        render(world, beams(np.tile([0.3, 0.4, 3.0], (64, 1)), down(1.0)), CENTRE, Options(paths=1500, orders=n))
        for n in (1, 0)
    )
    assert once.radiance[0, :, 0].mean() == pytest.approx(right, rel=0.01)
    assert all_orders.radiance[0, :, 0].mean() > 1.3 * right


@pytest.mark.parametrize("interpolation", ["nearest", "straight", "extinction"])
def test_a_furnace_is_even(interpolation: str) -> None:
    """What scatters everything under a sky of 1 all round cannot be seen; under half a sky it can."""
    rgba = volume()[::2, ::2, ::2]
    rgba[..., :3] = 1.0
    world = slab(rgba, 1 / 32, interpolation=interpolation, light="scattering", asymmetry=0.6, e_sky=EVEN,
                 sky_below=1.0, background=lambda d: np.ones((len(d), 3)))  # fmt: skip
    looking = volume_camera(*np.mgrid[20:108:11, 20:108:11])
    found = render(world, looking, CENTRE, Options(paths=10)).radiance
    assert found[..., 3].max() > 0.9
    assert found[..., :3] == pytest.approx(1.0, abs=2e-5), "what hides less than 1e-5 is left out"
    half = render(dataclasses.replace(world, sky_below=0.0), looking, CENTRE, Options(paths=10)).radiance
    assert half[..., :3].min() < 0.7


def test_faces_scatter_too() -> None:
    """An even floor under half a sky, and the sun through an absorber; then light that a floor sends up into matter."""
    square = np.array([[-1, -1, -0.2], [1, -1, -0.2], [1, 1, -0.2], [-1, 1, -0.2]], float) * [900, 900, 1]
    floor = Surface(square[[[0, 1, 2], [0, 2, 3]]], np.full((2, 3, 3), 0.4))
    black = layer(0.6, 0.0, 0.0, surfaces=(floor,), e_sky=EVEN, sun=(0.6, 0.0, 0.8), e_sun=(3.0, 2.0, 1.0))
    looking = beams(np.tile([0.3, 0.4, 3.0], (32, 1)), (0, 0, -1))
    found = render(dataclasses.replace(black, e_sky=(0, 0, 0)), looking, CENTRE, Options(paths=2000))
    right = 0.4 / math.pi * 0.8 * math.exp(-0.6 / 0.8) * math.exp(-0.6)
    assert found.radiance[0, :, :3].mean(axis=0) == pytest.approx(right * np.array([3, 2, 1]), rel=0.01)
    white = layer(0.6, 0.0, surfaces=(floor,), e_sky=EVEN)
    lit = render(white, looking, CENTRE, Options(paths=500)).radiance[0, :, 0].mean()
    dark = Surface(floor.corners, np.zeros((2, 3, 3)))
    unlit = render(dataclasses.replace(white, surfaces=(dark,)), looking, CENTRE, Options(paths=500))
    reflected = unlit.radiance[0, :, 0].mean()
    through = 1 - reflected
    assert reflected + 0.4 * through * math.exp(-0.6) < lit < reflected + 0.4 * through
    whole = dataclasses.replace(white, surfaces=(Surface(floor.corners, np.ones((2, 3, 3))),))
    assert render(whole, looking, CENTRE, Options(paths=10)).radiance[0, :, 0].mean() == pytest.approx(1.0, abs=0.02)


@pytest.mark.timeout(600)
def test_the_shared_volume_scatters_as_in_mitsuba() -> None:
    """Within 3 % of Mitsuba's means of blocks from one ray for four pixels, of 2 % noise; 0.9 % with 16 times as many
    paths, and 0.01 % in the mean."""
    rgba = volume()
    rgba[..., :3] = 0.99
    sun = np.array([-0.3, -0.4, 0.866]) / np.linalg.norm([0.3, 0.4, 0.866])
    world = slab(rgba, 1 / 64, interpolation="extinction", light="scattering", asymmetry=0.6, e_sun=(3.0,) * 3,
                 sun=tuple(sun), e_sky=tuple(0.3 * np.array(EVEN)), sky_below=1.0,
                 background=lambda d: np.full((len(d), 3), 0.3))  # fmt: skip
    found = render(world, volume_camera(*np.mgrid[0:128:2, 0:128:2]), np.array([[1.0, 1.0]]), Options(paths=12))
    difference = found.radiance[..., 0].reshape(8, 8, 8, 8).mean(axis=(1, 3)) - MITSUBA
    there = MITSUBA > 0.305
    assert there.sum() > 20
    assert np.abs(difference[MITSUBA < 0.3001]).max() < 1e-3
    rms = np.sqrt(np.mean(difference[there] ** 2))
    assert rms < 0.03 * MITSUBA[there].mean()
    assert rms < 0.15 * (MITSUBA[there] - 0.3).mean(), "of what is added to the sky"
    assert abs(difference[there].mean()) < 0.01 * MITSUBA[there].mean()


def test_wrong_options_are_named() -> None:
    looking = beams([0.3, 0.4, 3.0], (0, 0, -1))
    with pytest.raises(InputError, match="options"):
        render(layer(1, 0), looking, CENTRE, Options(paths=1))
    with pytest.raises(InputError, match="asymmetry"):
        render(layer(1, 1.0), looking, CENTRE)
