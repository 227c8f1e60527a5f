"""Delta-Eddington: its twin, its limits, energy, and DISORT's values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.scattering.delta_eddington import DeltaEddington
from tests.clouds.scattering import ladder

Ask = Callable[..., np.ndarray]
Baked = Callable[..., dict[str, np.ndarray]]
FILE = "clouds/scattering/delta_eddington.glsl"


@pytest.mark.parametrize("up", [True, False])
def test_the_shader_is_its_twin(ask: Ask, baked: Baked, up: bool) -> None:
    # Float32 in the table's places, where the forward peak rises by a tenth from one entry to the next.
    assert ladder.radiance_error(ask, baked, DeltaEddington(), up) < 2e-3


def test_fluxes_are_their_twins(ask: Ask, baked: Baked) -> None:
    assert ladder.flux_error(ask, baked, DeltaEddington()) < 5e-6


@pytest.mark.parametrize(("up", "right", "wrong"), [
    (True, "(1.0 - g * g) * (tau / m)", "(1.0 - g) * (tau / m)"),
    (False, "slab_direct(s.optical_depth, s.mu_sun) - once", "once"),
])
def test_a_wrong_light_is_found(
    ask: Ask, baked: Baked, spoil: Callable, up: bool, right: str, wrong: str
) -> None:
    with spoil(FILE, right, wrong):
        assert ladder.radiance_error(ask, baked, DeltaEddington(), up) > 1e-2


def test_its_limits(baked: Baked) -> None:
    """Nothing is scattered in no layer; through a thick one (2/3 + mu) / (4/3 + (1 - g) tau) passes."""
    model = DeltaEddington().model(ladder.arrays(DeltaEddington(), baked))
    g = model.asymmetry
    assert model.transmittance(0.0, 0.3) == pytest.approx([1, 1, 1])
    assert model.transmittance(256.0, 0.5) == pytest.approx((2 / 3 + 0.5) / (4 / 3 + (1 - g) * 256))


def test_nothing_is_lost(baked: Baked) -> None:
    assert ladder.unbalanced(DeltaEddington(), baked) < 1e-12
    for depth, sun in ((0.5, 0.7), (8.0, 0.4), (64.0, 1.0)):
        up, down = ladder.leaving(DeltaEddington(), baked, depth, sun)
        assert up + down + np.exp(-depth / sun) == pytest.approx(1, abs=5e-3)


def test_distance_to_disort(baked: Baked) -> None:
    """Two streams cost 0.04 of the beam at cosines of 0.4 and more, 0.1 at 0.1."""
    off = np.abs(ladder.reflectance_off(DeltaEddington(), baked) * ladder.REFLECTANCE)
    assert off[:, :3].max() < 0.04
    assert 0.05 < off.max() < 0.1
    assert np.median(np.abs(ladder.radiance_off(DeltaEddington(), baked, True))) < 0.6
