"""Adding and doubling: closed forms of thin layers, energy, its twin, and DISORT's values."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.doubling import Streams
from renderer.clouds.phase_tables import look_up
from renderer.clouds.scattering.adding_doubling import AddingDoubling
from renderer.clouds.slab import Slab
from tests.clouds.scattering import ladder

Ask = Callable[..., np.ndarray]
Baked = Callable[..., dict[str, np.ndarray]]
FILE = "clouds/scattering/adding_doubling.glsl"


@pytest.fixture(scope="module")
def technique() -> AddingDoubling:
    return AddingDoubling()


@pytest.mark.parametrize("up", [True, False])
def test_the_shader_is_its_twin(ask: Ask, baked: Baked, technique: AddingDoubling, up: bool) -> None:
    # Float32 in the table's places, where the forward peak rises by a tenth from one entry to the next.
    assert ladder.radiance_error(ask, baked, technique, up) < 2e-3


def test_fluxes_are_their_twins(ask: Ask, baked: Baked, technique: AddingDoubling) -> None:
    assert ladder.flux_error(ask, baked, technique) < 2e-6


@pytest.mark.parametrize(("up", "right", "wrong"), [
    (True, "slab_first(s, 1.0 - scattering_peak, up)", "slab_first(s, vec3(1.0), up)"),
    (True, "low = vec4(c, c2, c3, c4)", "low = vec4(c2, c, c3, c4)"),
    (True, "0.5 * (up ? place.z : place.z + 1.0)", "0.5 * (up ? place.z + 1.0 : place.z)"),
    (False, "1.0 + 0.1 * s.optical_depth", "1.0 + 0.2 * s.optical_depth"),
    (False, "SCATTERING_GLOW_STEP = 2.0", "SCATTERING_GLOW_STEP = 1.9"),
    (False, "scattering_peak_factor(s, up)", "1.0"),
    (True, "(s.cosine <= 0.0) == up", "(s.cosine > 0.0) == up"),
])
def test_a_wrong_light_is_found(
    ask: Ask, baked: Baked, spoil: Callable, technique: AddingDoubling, up: bool, right: str, wrong: str
) -> None:
    with spoil(FILE, right, wrong):
        assert ladder.radiance_error(ask, baked, technique, up) > 1e-2


@pytest.mark.parametrize("up", [True, False])
def test_orders_shown_alone_add_up(ask: Ask, technique: AddingDoubling, up: bool) -> None:
    assert ladder.parts_error(ask, technique, ("forward", "single", "rest"), up) < 1e-4


def test_nothing_is_lost(baked: Baked, technique: AddingDoubling) -> None:
    assert ladder.unbalanced(technique, baked) < 1e-12
    for depth, sun in ((0.5, 0.7), (8.0, 0.4), (64.0, 1.0)):
        up, down = ladder.leaving(technique, baked, depth, sun)
        assert up + down + np.exp(-depth / sun) == pytest.approx(1, abs=0.015)


def test_the_peak_blurs_the_glory(ask: Ask, baked: Baked, technique: AddingDoubling) -> None:
    """DISORT, depth 0.5, the sun at 0.4, view at 0.35 and 0.4 towards it: 177 degrees, a dark ring, and 180. Sharp
    rings would be 17 % too dark and 6 % too bright."""
    slab = Slab.between(np.array(0.5), np.array(0.4), np.array([0.35, 0.4]), np.array(np.pi), True)
    found = technique.model(ladder.arrays(technique, baked)).up(slab)[..., 0] / 0.4
    assert found == pytest.approx([0.044776, 0.101606], rel=0.03)


def test_a_thin_layer_scatters_once(baked: Baked, technique: AddingDoubling) -> None:
    """Closed form: P tau / mu_view on both sides, here within the second order's share of it."""
    arrays = ladder.arrays(technique, baked)
    for up in (True, False):
        slab = Slab.between(np.array(1e-4), np.array(0.6), np.linspace(0.2, 1, 9), np.array(1.0), up)
        model = technique.model(arrays)
        once = look_up(arrays["phase"]["value"], slab.cosine) * (1e-4 / slab.mu_view)[:, None]
        assert (model.up if up else model.down)(slab) == pytest.approx(once, rel=3e-3)


def test_isotropic_scattering_has_the_known_radiance() -> None:
    """A half-space's is H(mu) H(mu') mu' / (4 (mu + mu')) for each order 0; H(1) = 2.9078, H(0.5) = 2.0128 where
    nothing is absorbed (Chandrasekhar 1950, table XI)."""
    streams = Streams(np.array([1.0]), np.array([1.0, 0.5]), 16, 1)
    layer = streams.layers(np.array([2.0**14]))[0]
    found = np.diag(layer.reflection[0])[streams.wanted]
    assert found == pytest.approx([2.9078**2 / 4, 2.0128**2 / 4], rel=3e-4)


def test_distance_to_disort(baked: Baked, technique: AddingDoubling) -> None:
    """Budgets: tables over depth and cosine 0.1 %, delta-M at grazing sun 0.05 %; azimuths beyond 8, order 1 by the
    true P in the scaled layer, and the glow at grazing view the rest."""
    off = ladder.reflectance_off(technique, baked)
    assert np.abs(off).max() < 1.5e-3
    passed = ladder.REFLECTANCE * off / (1 - ladder.REFLECTANCE)
    assert np.abs(passed).max() < 2e-3
    up, down = (np.abs(ladder.radiance_off(technique, baked, side)) for side in (True, False))
    assert np.median(up) < 5e-3
    assert up.max() < 0.05
    assert np.median(down) < 1e-2
    assert down.max() < 0.2
