"""The air: closed forms of a vertical path, its tables against direct integrals, and light against traced photons."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import integrate

from renderer.world.atmosphere import (
    GROUND,
    MIE,
    MIE_ABSORPTION,
    MIE_HEIGHT,
    OZONE,
    OZONE_SPREAD,
    RAYLEIGH,
    RAYLEIGH_HEIGHT,
    TOP,
    Air,
    Atmosphere,
    breathe,
    coefficients,
    glow,
    optical_depth,
    shadow,
    to_ground,
    to_top,
    transmittance,
)
from renderer.world.sun import ANGULAR_RADIUS


@pytest.fixture(scope="module")
def air() -> Air:
    """The default air."""
    return breathe(Atmosphere(), ANGULAR_RADIUS)


def test_a_vertical_path_has_its_closed_form() -> None:
    """Exponentials integrate to their heights and the ozone tent to its spread; the tent's kinks cost 2e-3."""
    depth = 100.0
    expected = (
        RAYLEIGH * RAYLEIGH_HEIGHT * -np.expm1(-depth / RAYLEIGH_HEIGHT)
        + (MIE + MIE_ABSORPTION) * MIE_HEIGHT * -np.expm1(-depth / MIE_HEIGHT)
        + OZONE * OZONE_SPREAD
    )
    np.testing.assert_allclose(optical_depth(np.array([GROUND]), np.array([1.0]), 1.0)[0], expected, rtol=2e-3)


@pytest.mark.parametrize("mu", [0.0, 0.02, 0.3])
def test_a_slant_path_agrees_with_adaptive_quadrature(mu: float) -> None:
    """64 nodes along even a level ray lose less than 3e-3."""
    r = GROUND + 0.5
    length = float(to_top(np.array(r), np.array(mu)))

    def green(t: float) -> float:
        height = np.sqrt(r * r + t * t + 2.0 * r * mu * t) - GROUND
        return float(coefficients(np.array(height), 1.0)[2][1])

    expected = integrate.quad(green, 0.0, length, limit=400)[0]
    found = optical_depth(np.array([r]), np.array([mu]), 1.0)[0, 1]
    assert found == pytest.approx(expected, rel=3e-3)


def test_the_table_looks_up_what_it_was_made_from(air: Air) -> None:
    """Interpolated transmittance stays within 0.004 of the integral, at any height and above the horizon."""
    random = np.random.default_rng(1)
    r = GROUND + 100.0 * random.random(400) ** 2
    horizon = -np.sqrt(1.0 - (GROUND / r) ** 2)
    mu = horizon + 1e-3 + (1.0 - horizon - 1e-3) * random.random(400) ** 2
    expected = np.exp(-optical_depth(r, mu, 1.0))
    np.testing.assert_allclose(transmittance(air, r, mu), expected, atol=4e-3)


def test_distances_to_shells() -> None:
    """Straight up, straight down and past the Earth."""
    r = np.array([GROUND + 10.0])
    assert to_top(r, np.array([1.0]))[0] == pytest.approx(TOP - GROUND - 10.0)
    assert to_ground(r, np.array([-1.0]))[0] == pytest.approx(10.0)
    assert np.isinf(to_ground(r, np.array([0.0]))[0])
    assert np.isinf(to_ground(r, np.array([1.0]))[0])


def test_the_earths_shadow_has_the_suns_width() -> None:
    """Half the disc shows when its centre stands on the horizon; none and all of it one radius away."""
    r = np.full(3, GROUND + 5.0)
    horizon = -np.arccos(GROUND / r)
    seen = shadow(r, np.sin(horizon + ANGULAR_RADIUS * np.array([-1.05, 0.0, 1.05])), ANGULAR_RADIUS)
    np.testing.assert_allclose(seen, [0.0, 0.5, 1.0], atol=0.01)


def test_more_ground_light_and_more_haze_glow_more(air: Air) -> None:
    """Multiple scattering grows with what the ground throws back, and vanishes in the Earth's shadow."""
    r, mu = np.array([GROUND + 1.0]), np.array([0.7])
    snow = breathe(Atmosphere(ground_albedo=0.9), ANGULAR_RADIUS)
    assert (glow(snow, r, mu) > 1.1 * glow(air, r, mu)).all()
    assert (glow(air, r, np.array([-0.3])) == 0.0).all()


def _cosines(g: float | None, random: np.random.Generator, n: int) -> np.ndarray:
    """Scattering angles drawn from the phase function by its numerical inverse: molecules (None) or haze (g)."""
    x = np.linspace(-1.0, 1.0, 4001)
    density = 1.0 + x * x
    if g is not None:
        density = density / (1.0 + g * g - 2.0 * g * x) ** 1.5
    total = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]))])
    return np.interp(random.random(n), total / total[-1], x)


def photons(band: int, mu: float, albedo: float, count: int) -> float:
    """Diffuse irradiance of the ground per unit of the sun's, by photons traced through flat air, all orders.

    Shares with the code under test only the table of coefficients: free paths in optical depth, the event drawn by its
    share of extinction, the phase functions sampled, a Lambert ground.
    """
    random = np.random.default_rng(7)
    heights = np.linspace(0.0, 100.0, 4001)
    rayleigh, mie, extinction = (c[:, band] for c in coefficients(heights, 1.0))
    above = integrate.cumulative_trapezoid(extinction[::-1], dx=heights[1], initial=0.0)[::-1]
    depth, w = np.zeros(count), np.full(count, -mu)  # optical depth from the top; vertical cosine, down is negative
    scattered, landed = np.zeros(count, bool), 0
    while depth.size:
        depth = depth - w * random.exponential(size=depth.size)
        ground = depth >= above[0]
        landed += int(np.count_nonzero(ground & scattered))
        alive = (depth > 0.0) & (~ground | (random.random(depth.size) < albedo))
        depth, w, ground = np.where(ground, above[0], depth)[alive], w[alive], ground[alive]
        place = np.interp(depth, above[::-1], heights[::-1])
        pick = random.random(depth.size) * np.interp(place, heights, extinction)
        r, m = np.interp(place, heights, rayleigh), np.interp(place, heights, mie)
        turn = np.where(pick < r, _cosines(None, random, depth.size), _cosines(0.8, random, depth.size))
        around = np.cos(2.0 * np.pi * random.random(depth.size))
        turned = w * turn + np.sqrt((1.0 - w * w).clip(0.0) * (1.0 - turn * turn)) * around
        w = np.where(ground, np.sqrt(random.random(depth.size)), turned)
        kept = ground | (pick < r + m)
        depth, w, scattered = depth[kept], w[kept].clip(-1.0, 1.0), np.ones(int(kept.sum()), bool)
    return mu * landed / count


def test_traced_photons_see_the_ground() -> None:
    """The judge judged: what the ground throws back reaches it again."""
    assert photons(2, 0.7, 0.0, 20_000) < photons(2, 0.7, 0.9, 20_000)
