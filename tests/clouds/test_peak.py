"""What the forward peak makes of order 1: its limits, and energy."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.clouds.peak import escaping, factors, parts, transmitted_spectrum, twice_or_more
from renderer.clouds.phase_tables import phase_arrays

LOBE = 0.9 ** np.arange(300)


def test_the_parts_hold_all() -> None:
    ahead, behind = parts(LOBE)
    assert ahead + behind == pytest.approx(LOBE)
    assert ahead[0] + behind[0] == pytest.approx(1)
    backward = 0.19 / 1.8 * (1 / np.sqrt(1.81) - 1 / 1.9)  # of this lobe, beyond 90 degrees
    assert backward < behind[0] < 4 * backward
    assert np.abs(np.diff(ahead[150:])).max() < 1e-4


def test_a_peak_that_is_a_needle_blurs_nothing() -> None:
    """Where small deflections keep everything but do not turn, order 1 passes as through the scaled layer."""
    f, path = 0.4, 1.7
    kept = np.full(5, f)
    moments = np.array([1.0, 0.8, 0.7, 0.6, 0.5])
    found = transmitted_spectrum(moments, kept, f, path)
    # Of the needle itself: order 1 of P in the true layer holds f t e^(-t) of it, the glow the rest.
    glow = np.exp(-f * path) / path * (np.exp(f * path) - 1)
    assert found == pytest.approx(moments - f + glow)
    assert escaping(f, path) == pytest.approx((1 - np.exp(-(1 - f) * path)) / (1 - f))


def test_the_glow_has_the_energy_that_the_peak_takes() -> None:
    """Moment 0, times t e^(-(1 - f) t): e^(-(1 - f) t) - e^-t by the peak, and (1 - f) t e^(-(1 - f) t) by the rest."""
    f, path = 0.45, 2.3
    kept = f * 0.95 ** np.arange(40)
    found = transmitted_spectrum(0.9 ** np.arange(40), kept, f, path)[0] * path * np.exp(-(1 - f) * path)
    thin, thick = np.exp(-(1 - f) * path), np.exp(-path)
    assert found == pytest.approx(thin - thick + (1 - f) * path * thin)


def test_two_events_or_more_are_exact_where_they_are_few() -> None:
    assert twice_or_more(np.array([1e-4, 0.0999, 0.1001, 3.0])) == pytest.approx(
        [5.0001666e-9, np.expm1(0.0999) - 0.0999, np.expm1(0.1001) - 0.1001, np.exp(3.0) - 4], rel=1e-6)


def test_what_has_no_peak_is_left_alone() -> None:
    even = phase_arrays(np.tile(np.array([1.0, 0.0, 0.1]), (3, 1)))
    assert (factors(even, np.zeros(3), 32) == 1).all()
