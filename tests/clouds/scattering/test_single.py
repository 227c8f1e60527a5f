"""Order 1: its twin, its closed forms by quadrature, and how dark it leaves a cloud."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.bows import bows
from renderer.clouds.phase.mie import Mie
from renderer.clouds.phase_tables import SUN_RADIUS
from renderer.clouds.scattering.single import Single
from renderer.clouds.slab import Slab, first_down, first_up, second_down, second_up
from tests.clouds.scattering import ladder

Ask = Callable[..., np.ndarray]
Baked = Callable[..., dict[str, np.ndarray]]
FILE = "clouds/scattering/single.glsl"


@pytest.mark.parametrize("up", [True, False])
def test_the_shader_is_its_twin(ask: Ask, baked: Baked, up: bool) -> None:
    # Float32 in the table's places, where the forward peak rises by a tenth from one entry to the next.
    assert ladder.radiance_error(ask, baked, Single(), up) < 2e-3


def test_fluxes_are_their_twins(ask: Ask, baked: Baked) -> None:
    assert ladder.flux_error(ask, baked, Single()) < 5e-6


@pytest.mark.parametrize(("up", "right", "wrong"), [
    (True, "slab_first_up(s, vec3(1.0))", "slab_first_up(s, vec3(2.0))"),
    (False, "phase_value(s.cosine) * slab_first_down", "phase_value(-s.cosine) * slab_first_down"),
])
def test_a_wrong_light_is_found(
    ask: Ask, baked: Baked, spoil: Callable, up: bool, right: str, wrong: str
) -> None:
    with spoil(FILE, right, wrong):
        assert ladder.radiance_error(ask, baked, Single(), up) > 1e-2


@pytest.mark.parametrize(("depth", "sun", "view"), [(0.3, 0.7, 0.5), (4.0, 0.3, 0.9), (2.0, 0.6, 0.6)])
def test_closed_forms_are_their_integrals(depth: float, sun: float, view: float) -> None:
    """Order 1: dx / mu_view e^(-x / mu_sun) e^(-(way out) / mu_view); order 2 as formulas a4 have it."""
    x = (np.arange(200000) + 0.5) / 200000 * depth
    step = depth / len(x) / view
    slab = Slab(*(np.array(value) for value in (depth, sun, view, 0.0, 0.0)))
    assert first_up(slab) == pytest.approx(float(np.exp(-x / sun - x / view).sum() * step), rel=1e-6)
    through = np.exp(-x / sun - (depth - x) / view)
    assert first_down(slab) == pytest.approx(float(through.sum() * step), rel=1e-6)
    before = x / sun + (depth - x) / view
    assert second_down(slab) == pytest.approx(float((before * through).sum() * step / 2), rel=1e-6)
    bent = np.exp(-x / sun - x / view) * (x / sun + x / view)
    assert second_up(slab) == pytest.approx(float(bent.sum() * step / 2), rel=1e-6)


def test_its_flux_is_that_of_its_radiance(baked: Baked) -> None:
    model = Single().model(ladder.arrays(Single(), baked))
    for depth, sun in ((0.5, 0.7), (8.0, 0.4)):
        up, down = ladder.leaving(Single(), baked, depth, sun)
        assert model.reflectance(depth, sun)[0] == pytest.approx(up, rel=3e-3)
        passed = model.transmittance(depth, sun)[0] - np.exp(-depth / sun)
        assert passed == pytest.approx(down, rel=0.02, abs=1e-4)


def test_a_thick_cloud_is_far_too_dark(baked: Baked) -> None:
    """Less than a twentieth of what DISORT sends back at a depth of 32, under a high sun."""
    assert (ladder.reflectance_off(Single(), baked)[3, :2] < -0.95).all()
    assert ladder.unbalanced(Single(), baked) > 0.9
    assert not Single.conserves


def test_fogbow_and_glory_stand_where_the_droplets_put_them(ask: Ask, baked: Baked) -> None:
    """In the shader's light of a cloud seen from above, the sun overhead: fogbow within 0.25 degrees, rings within
    0.1."""
    droplets = Mie()
    away = np.radians(np.concatenate([np.arange(0.3, 6, 0.01), np.arange(34, 43, 0.02)]))
    inputs = {"mu": np.cos(away)}
    found = ask({"phase": droplets, "scattering": Single()}, "scattering_up(Slab(8.0, 1.0, mu, -mu, 1.0))", inputs)
    moments = baked(droplets.phase_bake())["moments"]
    near = away < np.radians(10)
    for band in range(3):
        known = bows(moments[band], SUN_RADIUS)
        bow = away[~near][np.argmax(found[~near, band])]
        assert np.degrees(abs(bow - known.fogbow)) < 0.25
        rings, light = away[near], found[near, band]
        for ring in known.glory[:3]:
            beside = np.abs(rings - ring) < np.radians(0.35)
            bright = rings[beside][np.argmax(light[beside])]
            assert np.degrees(abs(bright - ring)) < 0.1
