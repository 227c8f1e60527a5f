"""The thesis' orders: their twin, and that order 2 is twice too bright."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.scattering.thesis_orders import ThesisOrders
from renderer.clouds.slab import Slab, first_up, second_up
from tests.clouds.scattering import ladder

Ask = Callable[..., np.ndarray]
Baked = Callable[..., dict[str, np.ndarray]]
FILE = "clouds/scattering/thesis_orders.glsl"


@pytest.mark.parametrize("up", [True, False])
def test_the_shader_is_its_twin(ask: Ask, baked: Baked, up: bool) -> None:
    # Float32 in the table's places, where the forward peak rises by a tenth from one entry to the next.
    assert ladder.radiance_error(ask, baked, ThesisOrders(), up) < 2e-3


def test_fluxes_are_their_twins(ask: Ask, baked: Baked) -> None:
    assert ladder.flux_error(ask, baked, ThesisOrders()) < 5e-6


@pytest.mark.parametrize(("up", "right", "wrong"), [
    (True, "phase_twice(s.cosine) * once, rest);\n}\n\nvec3 scattering_down",
     "phase_twice(s.cosine) * slab_second_up(s), rest);\n}\n\nvec3 scattering_down"),
    (True, "ahead / (path - (path - 1.0) * ahead)", "ahead / (path - path * ahead)"),
    (False, "exp(-(1.0 - phase_forward) * path) - exp(-path)",
     "exp(-(1.0 - phase_forward) * path)"),
])
def test_a_wrong_light_is_found(
    ask: Ask, baked: Baked, spoil: Callable, up: bool, right: str, wrong: str
) -> None:
    with spoil(FILE, right, wrong):
        assert ladder.radiance_error(ask, baked, ThesisOrders(), up) > 1e-2


@pytest.mark.parametrize("up", [True, False])
def test_orders_shown_alone_add_up(ask: Ask, up: bool) -> None:
    orders = ("transparency", "forward", "single", "double", "rest")
    assert ladder.parts_error(ask, ThesisOrders(), orders, up) < 1e-4


@pytest.mark.parametrize(
    ("depth", "sun", "low", "high"), [(2.0, 0.7, 1.9, 2.2), (8.0, 0.4, 1.95, 2.1), (0.2, 0.7, 3.0, 12.0)]
)
def test_order_2_is_too_bright(baked: Baked, depth: float, sun: float, low: float, high: float) -> None:
    """Printed over corrected: 2 in a thick layer, ever more in a thin one (errata 001-16: 16 at 0.05, 1.8 at 8)."""
    slab = Slab.between(np.array(depth), np.array(sun), np.array([0.65]), np.array([2.0]), True)
    ratio = first_up(slab) / second_up(slab)
    assert low < float(ratio[0]) < high


def test_what_the_slab_keeps_it_lets_through(baked: Baked) -> None:
    assert ladder.unbalanced(ThesisOrders(), baked) < 1e-12


def test_its_radiances_are_more_than_the_beam_brings(baked: Baked) -> None:
    """The forward peak counts twice, and order 2 too much: of a thin layer a third more leaves than came."""
    up, down = ladder.leaving(ThesisOrders(), baked, 0.5, 0.7)
    assert up + down + np.exp(-0.5 / 0.7) > 1.3


def test_distance_to_disort(baked: Baked) -> None:
    """One dimension along the ray costs 0.06 of the beam at cosines of 0.4 and more, 0.17 at 0.1 in a thin layer."""
    off = np.abs(ladder.reflectance_off(ThesisOrders(), baked) * ladder.REFLECTANCE)
    assert off[:, :3].max() < 0.06
    assert 0.15 < off.max() < 0.18
