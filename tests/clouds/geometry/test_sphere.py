"""The layer as a shell: against long doubles, closed forms, and what float32 alone would give."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.geometry.sphere import Sphere
from tests.clouds.geometry import shells
from tests.clouds.geometry.shells import BASE, DECLARED, RADIUS, TOP

Ask = Callable[..., np.ndarray]
BODY = (
    f"vec2(geometry_leg(path_of(o, w), 0, {BASE}, {TOP - BASE}, 0.0, NEVER), "
    f"geometry_leg(path_of(o, w), 1, {BASE}, {TOP - BASE}, 0.0, NEVER))"
)


def lengths(ask: Ask, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
    return ask(
        {"geometry": Sphere()},
        BODY,
        {"o": origins, "w": directions},
        2,
        files=["clouds/path.glsl"],
        values={"planet_radius": RADIUS},
        declarations=DECLARED,
    )


def slant(ask: Ask, mu: np.ndarray) -> np.ndarray:
    return ask(
        {"geometry": Sphere()},
        f"geometry_slant(mu, {BASE}, {TOP - BASE})",
        {"mu": mu},
        1,
        files=["clouds/path.glsl"],
        values={"planet_radius": RADIUS},
        declarations=DECLARED,
    )[..., 0]


def test_ten_thousand_rays_from_everywhere(ask: Ask) -> None:
    origins, directions = shells.rays(10_000)
    exact = shells.legs(origins, directions)
    twice = (exact > 0).all(axis=-1)
    assert twice.sum() > 1000, "rays that cross the shell twice are among them"
    assert shells.wrong(lengths(ask, origins, directions), origins, directions) == 0


def test_plain_float32_is_found(ask: Ask, spoil: Callable) -> None:
    """Without the pairs of floats, rays from 20,000 km cross it elsewhere."""
    origins, directions = shells.rays(10_000)
    with spoil("clouds/path.glsl", "return vec2(s, (a - (s - v)) + (b - v));", "return vec2(s, 0.0);"):
        assert shells.wrong(lengths(ask, origins, directions), origins, directions) > 100


def test_the_printed_double_crossing_is_found(ask: Ask, spoil: Callable) -> None:
    """Belcour prints the far stretch without its factor (errata 001-1): a chord is not twice its half."""
    origins, directions = shells.rays(2000)
    with spoil("clouds/path.glsl", "legs.zw = down ? vec2(inner - b, side)", "legs.zw = down ? vec2(inner - b, 0.0)"):
        assert shells.wrong(lengths(ask, origins, directions), origins, directions) > 100


def test_the_sun_s_slant(ask: Ask) -> None:
    mu = np.array([1.0, 0.5, 0.1, 0.01, 0.0])
    low, high = RADIUS + BASE, RADIUS + TOP
    exact = np.sqrt(high**2 - low**2 * (1 - mu**2)) - low * mu
    assert slant(ask, mu) == pytest.approx(exact, rel=2e-4)
    assert slant(ask, mu)[-1] == pytest.approx(35_644, rel=1e-3), (
        "36 km along the horizon, where the flat slab is endless"
    )
