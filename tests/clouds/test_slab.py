"""Every scattering technique at the ends of its range, and closed forms in float32 against their float64 twins."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.phase.henyey_greenstein import HenyeyGreenstein
from renderer.clouds.slab import mean_decay, ramped_decay
from renderer.core.registry import techniques
from tests.clouds.scattering import ladder

Ask = Callable[..., np.ndarray]

ENDS = np.array(list(itertools.product(
    (0.0, 1e-6, 1e-3, 1.0, 256.0, 1e5), (0.0, 1e-6, 1e-3, 0.5, 1.0), (0.0, 1e-3, 0.5, 1.0), (-1.0, 0.0, 1.0),
    (-1.0, 1.0),
)))


@pytest.mark.parametrize("kind", techniques("clouds", "scattering"))
def test_light_is_finite_and_not_negative_anywhere(ask: Ask, kind: str) -> None:
    chosen = {"phase": HenyeyGreenstein(), "scattering": techniques("clouds", "scattering")[kind]()}
    inputs = {"p": ENDS[:, :3], "q": ENDS[:, 3:]}
    for up in ("true", "false"):
        found = ask(chosen, f"scattering_leaving({ladder.SLAB}, {up})", inputs)
        assert np.isfinite(found).all()
        assert found.min() >= 0
        assert found[ENDS[:, 0] == 0].max() < 1e-6
    for name in ("reflectance", "transmittance", "direct"):
        share = ask(chosen, f"scattering_{name}(p.x, p.y)", inputs)
        assert np.isfinite(share).all()
        assert share.min() >= 0
        assert share.max() <= 1 + 1e-6
        assert share[ENDS[:, 0] == 0] == pytest.approx(0 if name == "reflectance" else 1, abs=1e-6)


def test_decays_keep_their_digits() -> None:
    """(1 - e^-x) / x and (1 - (1 + x) e^-x) / x^2, against series for small x and themselves across the seam."""
    x = np.array([0.0, 1e-8, 1e-3, 0.00999, 0.01001, 0.0999, 0.1001, 2.0, 1e4])
    exact = np.array([1, 1 - 5e-9, *(-np.expm1(-x[2:]) / x[2:])])
    assert mean_decay(x) == pytest.approx(exact, rel=1e-10)
    assert ramped_decay(np.array([0.0, 1e-6])) == pytest.approx([0.5, 0.5 - 1e-6 / 3], rel=1e-10)
    seam = ramped_decay(np.array([0.1 - 1e-9, 0.1 + 1e-9]))
    assert seam[0] == pytest.approx(seam[1], rel=1e-7)
    assert ramped_decay(np.array([2.0])) == pytest.approx([(1 - 3 * np.exp(-2)) / 4])
