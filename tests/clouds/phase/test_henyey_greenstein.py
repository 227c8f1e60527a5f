"""Henyey and Greenstein's lobe: closed forms, moments, and what a wrong exponent does."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.legendre import gauss, values_of
from renderer.clouds.phase.henyey_greenstein import HenyeyGreenstein
from tests.clouds.phase.angles import COSINES, integral

Ask = Callable[..., np.ndarray]
LOBE = HenyeyGreenstein(asymmetry=0.8)


def lobe(g: float) -> np.ndarray:
    return np.tile(((1 - g**2) / (4 * np.pi) / (1 + g**2 - 2 * g * COSINES) ** 1.5)[:, None], (1, 3))


def error(ask: Ask, body: str, g: float) -> float:
    return float(np.abs(ask({"phase": LOBE}, body, {"c": COSINES}) / lobe(g) - 1).max())


@pytest.mark.parametrize(("body", "g"), [("phase_value(c)", 0.8), ("phase_twice(c)", 0.64)])
def test_the_closed_form(ask: Ask, body: str, g: float) -> None:
    assert error(ask, body, g) < 1e-5


def test_a_wrong_exponent_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil("clouds/phase/henyey_greenstein.glsl", "base * sqrt(base)", "base"):
        assert error(ask, "phase_value(c)", 0.8) > 0.1


def test_the_integral_over_the_sphere_is_one(ask: Ask) -> None:
    nodes, weights = gauss(400)
    for body in ("phase_value(c)", "phase_twice(c)"):
        assert integral(ask({"phase": LOBE}, body, {"c": nodes}), nodes, weights) == pytest.approx([1, 1, 1], abs=1e-5)


@pytest.mark.parametrize("g", [0.0, 0.8, 0.97])
def test_its_moments_are_its_own(baked: Callable, g: float) -> None:
    arrays = baked(HenyeyGreenstein(asymmetry=g).phase_bake())
    assert arrays["asymmetry"] == pytest.approx([g] * 3)
    known = (1 - g**2) / (4 * np.pi) / (1 + g**2 - 2 * g * 0.5) ** 1.5
    assert values_of(arrays["moments"][0], np.array(0.5)) == pytest.approx(known, rel=1e-3)
    # Within 5 degrees: the closed form of the lobe's integral over a cap.
    c = np.cos(np.radians(5))
    cap = (1 - g**2) / (2 * g) * (1 / (1 - g) - 1 / np.sqrt(1 + g**2 - 2 * g * c)) if g else (1 - c) / 2
    assert arrays["forward"] == pytest.approx([cap] * 3, abs=1e-5)
