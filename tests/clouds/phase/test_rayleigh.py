"""Rayleigh's phase function: closed forms, moments, and a wrong sign."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.legendre import gauss, values_of
from renderer.clouds.phase.rayleigh import Rayleigh
from tests.clouds.phase.angles import COSINES, integral

Ask = Callable[..., np.ndarray]
MOMENTS = np.array([1.0, 0.0, 0.1])


def error(ask: Ask, body: str, moments: np.ndarray) -> float:
    twin = values_of(moments, COSINES)[:, None]
    return float(np.abs(ask({"phase": Rayleigh()}, body, {"c": COSINES}) / twin - 1).max())


@pytest.mark.parametrize(("body", "moments"), [("phase_value(c)", MOMENTS), ("phase_twice(c)", MOMENTS**2)])
def test_the_closed_form(ask: Ask, body: str, moments: np.ndarray) -> None:
    assert error(ask, body, moments) < 1e-5


@pytest.mark.parametrize(("body", "right", "wrong"), [
    ("phase_value(c)", "(1.0 + cosine * cosine)", "(1.0 - cosine * cosine)"),
    ("phase_twice(c)", "0.025", "0.25"),
])
def test_a_wrong_form_is_found(ask: Ask, spoil: Callable, body: str, right: str, wrong: str) -> None:
    moments = MOMENTS if "value" in body else MOMENTS**2
    with spoil("clouds/phase/rayleigh.glsl", right, wrong):
        assert error(ask, body, moments) > 0.05


def test_the_integral_over_the_sphere_is_one(ask: Ask) -> None:
    nodes, weights = gauss(50)
    for body in ("phase_value(c)", "phase_twice(c)"):
        found = integral(ask({"phase": Rayleigh()}, body, {"c": nodes}), nodes, weights)
        assert found == pytest.approx([1, 1, 1], abs=1e-5)


def test_its_bake_is_no_wider_than_it(baked: Callable) -> None:
    arrays = baked(Rayleigh().phase_bake())
    assert arrays["moments"] == pytest.approx(np.tile(MOMENTS, (3, 1)))
    assert arrays["forward"] == pytest.approx([0.00286] * 3, abs=2e-5)
