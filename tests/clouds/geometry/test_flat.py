"""The flat slab: its closed form, its agreement with the sphere, and where it fails."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.geometry.flat import Flat
from tests.clouds.geometry.shells import BASE, DECLARED, RADIUS, TOP

Ask = Callable[..., np.ndarray]
HEIGHT = TOP - BASE


def through(ask: Ask, body: str, inputs: dict[str, np.ndarray]) -> np.ndarray:
    return ask(
        {"geometry": Flat()},
        body,
        inputs,
        1,
        files=["clouds/path.glsl"],
        values={"planet_radius": RADIUS},
        declarations=DECLARED,
    )[..., 0]


def test_thickness_over_cosine(ask: Ask) -> None:
    mu = np.array([1.0, 0.6, 0.2, 0.05])
    assert through(ask, f"geometry_slant(mu, {BASE}, {HEIGHT})", {"mu": mu}) == pytest.approx(HEIGHT / mu, rel=1e-5)


@pytest.mark.parametrize(("altitude", "ahead"), [(0.0, 1.0), (2550.0, 0.5), (2590.0, 0.1), (2700.0, 0.0)])
def test_a_camera_sees_what_lies_ahead(ask: Ask, altitude: float, ahead: float) -> None:
    """Looking straight up from below, from inside and from above the layer."""
    body = f"geometry_leg(path_of(vec3(0.0, 0.0, z), vec3(0.0, 0.0, 1.0)), 1, {BASE}, {HEIGHT}, 1.0, NEVER)"
    assert through(ask, body, {"z": np.array([altitude])})[0] == pytest.approx(ahead * HEIGHT, rel=1e-3, abs=1e-6)


def test_the_ground_cuts_it_off(ask: Ask) -> None:
    body = f"geometry_leg(path_of(vec3(0.0, 0.0, 3000.0), vec3(0.0, 0.0, -1.0)), 0, {BASE}, {HEIGHT}, -1.0, end)"
    assert through(ask, body, {"end": np.array([425.0])})[0] == pytest.approx(25.0, rel=1e-3)


def test_it_agrees_with_the_sphere_away_from_the_limb(ask: Ask) -> None:
    """Errata 001-3: at 0.4 rad they differ by a few millionths, not from there on as fig. 4.8 says."""
    low, high = RADIUS + BASE, RADIUS + TOP
    mu = np.cos(np.array([0.4, 1.2]))
    sphere = (high**2 - low**2) / (np.sqrt(high**2 - low**2 * (1 - mu**2)) + low * mu)
    flat = through(ask, f"geometry_slant(mu, {BASE}, {HEIGHT})", {"mu": mu})
    assert np.abs(flat / sphere - 1).max() < 2e-4


def test_it_explodes_at_the_limb(ask: Ask) -> None:
    flat = through(ask, f"geometry_slant(mu, {BASE}, {HEIGHT})", {"mu": np.array([1e-3])})[0]
    assert flat == pytest.approx(1e5, rel=1e-5), "three times the longest path on the sphere"


def test_a_sine_in_the_cosine_s_place_is_found(ask: Ask, spoil: Callable) -> None:
    mu = np.array([0.2])
    with spoil(
        "clouds/geometry/flat.glsl",
        "return min(thickness / max(abs(mu), 1.0e-20), FLAT_LONGEST);",
        "return min(thickness / sqrt(1.0 - mu * mu), FLAT_LONGEST);",
    ):
        found = through(ask, f"geometry_slant(mu, {BASE}, {HEIGHT})", {"mu": mu})
    assert abs(found[0] * mu[0] / HEIGHT - 1) > 0.5
