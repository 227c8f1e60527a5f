"""The shell in plain float32: its twin, what it is right for, and what cancels."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.geometry.sphere import Sphere
from renderer.clouds.geometry.sphere_naive import SphereNaive
from tests.clouds.geometry import shells
from tests.clouds.geometry.shells import BASE, DECLARED, RADIUS, TOP

Ask = Callable[..., np.ndarray]
HEIGHT = TOP - BASE


def through(ask: Ask, body: str, inputs: dict[str, np.ndarray], outputs: int = 1) -> np.ndarray:
    return ask(
        {"geometry": SphereNaive()},
        body,
        inputs,
        outputs,
        files=["clouds/path.glsl"],
        values={"planet_radius": RADIUS},
        declarations=DECLARED,
    )


def lengths(ask: Ask, height: float) -> tuple[np.ndarray, np.ndarray]:
    """Of a thousand rays from everywhere through a layer so thick: found and exact, (N, 2) m."""
    origins, directions = shells.rays(1000)
    body = ", ".join(f"geometry_leg(path_of(o, w), {leg}, {BASE}, {height}, 0.0, NEVER)" for leg in (0, 1))
    exact = shells.legs(origins, directions) if height == HEIGHT else np.zeros((1000, 2))
    return through(ask, f"vec2({body})", {"o": origins, "w": directions}, 2), exact


def test_in_doubles_its_formula_is_the_shells() -> None:
    mu = np.geomspace(1e-3, 1.0, 20)
    given = (RADIUS, BASE, HEIGHT)
    assert SphereNaive.slant(mu, *given) == pytest.approx(Sphere.slant(mu, *given), rel=1e-6)


def test_a_thick_layer_is_found_near_by(ask: Ask) -> None:
    found, exact = lengths(ask, HEIGHT)
    seen = (exact > 1000.0).any(axis=-1) & (shells.rays(1000)[0][:, 2] < 1e4)
    assert np.median(np.abs(found / np.maximum(exact, 1.0) - 1)[seen & (exact > 0).all(axis=-1)]) < 0.02


def test_what_it_says_of_the_sun_is_its_twin_s(ask: Ask) -> None:
    mu = np.linspace(0.05, 1.0, 200).astype(np.float32)
    found = through(ask, f"geometry_slant(mu, {BASE}, {HEIGHT})", {"mu": mu})[..., 0]
    # Each may round the other way: a square's last digit is worth 4e6 m2 over 2 H1 mu.
    digit = 2 * 4.2e6 / (2 * RADIUS * mu) + 0.5
    assert (np.abs(found - SphereNaive.slant(mu, RADIUS, BASE, HEIGHT)) <= digit).all()


def test_a_thin_layer_is_thick_or_thin_by_chance(ask: Ask) -> None:
    """Where the sphere's own form is right to a millionth."""
    mu = np.linspace(0.05, 0.9, 400).astype(np.float32)
    exact = Sphere.slant(mu.astype(float), RADIUS, BASE, 5.0)
    off = [
        np.abs(found / exact - 1)
        for found in (
            through(ask, f"geometry_slant(mu, {BASE}, 5.0)", {"mu": mu})[..., 0],
            Sphere.slant(mu, RADIUS, BASE, 5.0),
        )
    ]
    assert np.median(off[0]) > 0.02
    assert np.max(off[1]) < 1e-5


def test_a_lost_root_is_found(ask: Ask, spoil: Callable) -> None:
    mu = np.array([0.2], np.float32)
    with spoil("clouds/geometry/sphere_naive.glsl", "- rounded(low * mu), 1.0e-3", "+ rounded(low * mu), 1.0e-3"):
        found = through(ask, f"geometry_slant(mu, {BASE}, {HEIGHT})", {"mu": mu})[0, 0]
    assert found > 2 * SphereNaive.slant(mu, RADIUS, BASE, HEIGHT)[0]
