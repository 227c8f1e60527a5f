"""Two planes cut to discs against the reference values, and every number that must come out."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.clouds.radiosity import numbers as module
from renderer.clouds.radiosity.numbers import cloud_share, cut, numbers
from renderer.clouds.radiosity.two_planes import exchange, solve

# c_radiosity.json of the reference values: error of the ground at the centre after bounces 1 to 8, albedos 0.9 and 0.3.
CENTRE = {
    4.0: (0.05882352941176916, 0.09565283069855468, 0.11350970203500155, 0.12035642945146707, 0.1226463622716617),
    8.0: (0.015384615384612887, 0.024175190908846456, 0.028940300594726853, 0.03110269235614782, 0.03196176956853192),
}


@pytest.mark.parametrize("radius", CENTRE)
def test_discs_are_those_of_the_reference_values(radius: float) -> None:
    found = solve(0.3, 0.9, radius, 5, np.array([0.0]))
    np.testing.assert_allclose(-found.ground_error[:, 0], CENTRE[radius], rtol=1e-10)
    assert found.endless_ground[-1] < 0.410958904 < found.endless_ground[-1] + 1e-3


def test_the_azimuth_integral_is_closed() -> None:
    angle = (np.arange(4000) + 0.5) / 4000 * 2 * np.pi
    for r, s in ((0.0, 1.0), (2.0, 2.1), (3.0, 0.5)):
        summed = np.mean(1 / (1 + r * r + s * s - 2 * r * s * np.cos(angle)) ** 2) * 2 * s
        assert exchange(np.array([r]), np.array([s]))[0, 0] == pytest.approx(summed, rel=1e-9)


@pytest.mark.parametrize("number", numbers(), ids=lambda number: number.quantity)
def test_comes_out(number: module.Number) -> None:
    assert number.agrees, (number.computed, number.right)


def test_a_wrong_number_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """The thesis' own values, as printed, do not pass."""
    monkeypatch.setattr(module, "cloud_share", lambda height: height / 6.35e6 * 10)
    monkeypatch.setattr(module, "cells_of_the_earth", lambda height: 80_000)
    monkeypatch.setattr(module, "disc", lambda radius: radius / (1 + radius))
    assert sum(not number.agrees for number in numbers()) >= 6


def test_the_share_of_cloud_is_not_lost_to_rounding() -> None:
    assert cloud_share(1.0) == pytest.approx(2 / 6.35e6, rel=1e-6)


def test_errors_fall_as_the_square_of_the_radius() -> None:
    errors = [cut(radius, 0.0, bounces=1)[0] for radius in (8.0, 16.0, 32.0)]
    np.testing.assert_allclose(errors, [1 / 65, 1 / 257, 1 / 1025], rtol=1e-9)
