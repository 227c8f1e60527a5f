"""Corrected orders: their twin, the shares of each, energy, and DISORT's values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.droplets import Droplets, scattering, water_index
from renderer.clouds.order_fluxes import bake_order_fluxes
from renderer.clouds.phase_tables import phase_arrays
from renderer.clouds.scattering.orders import Orders
from tests.clouds.scattering import ladder

Ask = Callable[..., np.ndarray]
Baked = Callable[..., dict[str, np.ndarray]]
FILE = "clouds/scattering/orders.glsl"


@pytest.mark.parametrize("up", [True, False])
def test_the_shader_is_its_twin(ask: Ask, baked: Baked, up: bool) -> None:
    # Float32 in the table's places, where the forward peak rises by a tenth from one entry to the next.
    assert ladder.radiance_error(ask, baked, Orders(), up) < 2e-3


def test_fluxes_are_their_twins(ask: Ask, baked: Baked) -> None:
    assert ladder.flux_error(ask, baked, Orders()) < 5e-6


@pytest.mark.parametrize(("up", "right", "wrong"), [
    (True, "phase_twice(s.cosine) * slab_second_up(s)",
     "phase_twice(s.cosine) * slab_first_up(s, vec3(1.0))"),
    (True, "(m - 0.4) / 0.3", "(m - 0.4) / 0.4"),
    (False, "vec3 met = phase_forward * path", "vec3 met = 0.5 * phase_forward * path"),
    (False, "- scattering_known(s, 1.0) - peak", "- scattering_known(s, 0.0) - peak"),
])
def test_a_wrong_light_is_found(
    ask: Ask, baked: Baked, spoil: Callable, up: bool, right: str, wrong: str
) -> None:
    with spoil(FILE, right, wrong):
        assert ladder.radiance_error(ask, baked, Orders(), up) > 1e-2


@pytest.mark.parametrize("up", [True, False])
def test_orders_shown_alone_add_up(ask: Ask, up: bool) -> None:
    orders = ("transparency", "forward", "single", "double", "rest")
    assert ladder.parts_error(ask, Orders(), orders, up) < 1e-4


def test_a_layer_thinner_than_all_is_no_layer(baked: Baked) -> None:
    model = Orders().model(ladder.arrays(Orders(), baked))
    assert model.transmittance(0.0, np.array([0.1, 0.5, 1.0])) == pytest.approx(np.ones((3, 3)))


# Orders 1 and 2 back, order 2 on, by Monte Carlo of 20,000 photons (standard error 0.001) with droplets of
# gamma-distributed radius, effective 7 um, 650 nm (formulas a4), and the same by the closed forms.
MONTE_CARLO = [(1.0, 1.0, 0.0139, 0.0146, 0.0108, 0.0106), (0.7, 2.0, 0.0190, 0.0195, 0.0196, 0.0191),
               (0.4, 8.0, 0.0362, 0.0386, 0.0399, 0.0366)]


@pytest.fixture(scope="module")
def hansen() -> dict[str, np.ndarray]:
    """The phase function of those droplets."""
    droplets = Droplets(radius=5.6, width=0.33, distribution="gamma")
    return phase_arrays(np.tile(scattering(droplets, 650e-9, water_index(650e-9))["moments"], (3, 1)))


@pytest.mark.parametrize(("sun", "depth", "first", "first_form", "second", "second_form"), MONTE_CARLO)
def test_shares_of_the_first_orders(
    hansen: dict, sun: float, depth: float, first: float, first_form: float, second: float, second_form: float
) -> None:
    model = Orders().model({"phase": hansen, "order_fluxes": bake_order_fluxes({}, {"phase": hansen}, lambda *_: None)})
    found = [float(model.order_flux(number, np.array(depth), np.array(sun))[0]) for number in (0, 2)]
    assert found == pytest.approx([first_form, second_form], rel=0.02)
    assert found == pytest.approx([first, second], rel=0.1)


def test_nothing_is_lost(baked: Baked) -> None:
    assert ladder.unbalanced(Orders(), baked) < 1e-12
    for depth, sun in ((0.5, 0.7), (8.0, 0.4), (64.0, 1.0)):
        up, down = ladder.leaving(Orders(), baked, depth, sun)
        assert up + down + np.exp(-depth / sun) == pytest.approx(1, abs=5e-3)


def test_distance_to_disort(baked: Baked) -> None:
    """The fit costs 0.007 of the beam where it stands, 0.09 at a cosine of 0.1, below it; order 2's form and the even
    exit of the rest half of the radiance in the darkest directions."""
    off = np.abs(ladder.reflectance_off(Orders(), baked) * ladder.REFLECTANCE)
    assert off[:, :3].max() < 0.007
    assert off.max() < 0.09
    assert np.median(np.abs(ladder.radiance_off(Orders(), baked, True))) < 0.45
    assert np.median(np.abs(ladder.radiance_off(Orders(), baked, False))) < 0.1
