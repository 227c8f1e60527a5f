"""Mie scattering of droplets against reference values.

Values without a file are copied from `b_mie.npz` and `b_mie_summary.json` of the shared reference folder (miepython
3.3.0, water of Hale & Querry 1973, radius 10 um).
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from renderer.clouds import droplets
from renderer.clouds.bows import bows
from renderer.clouds.legendre import disc_moments, gauss, moments_of, share_within, values_of
from renderer.clouds.phase.mie import Mie
from renderer.clouds.phase_tables import SUN_RADIUS

REFERENCE = Path(__file__).parents[2].parent / "shared" / "reference" / "b_mie.npz"

# Wavelength: asymmetry, extinction efficiency, share within 5 degrees, P at 0 and 180 degrees and at the fogbow.
COPIED = {
    650e-9: (0.8591864044, 2.033514621, 0.4642, 379.7661773, 0.0526597724, 0.0282018307),
    550e-9: (0.8632976705, 2.051397191, 0.4712, 535.0764774, 0.0370775215, 0.0284417983),
    450e-9: (0.8672928491, 2.078364691, 0.4956, 809.0543795, 0.0662552202, 0.0300909891),
}

# Radii from the antisolar point, sun's disc averaged, degrees: fogbow, and the glory's rings.
RINGS = {650e-9: (38.45, (1.8, 3.85, 5.7)), 550e-9: (38.8, (1.55, 3.25, 4.85)), 450e-9: (38.0, (1.25, 2.7, 4.0))}


@pytest.fixture(scope="module")
def narrow(baked: Callable[..., dict[str, np.ndarray]]) -> dict[float, dict[str, np.ndarray]]:
    """What the slot `phase` bakes, by wavelength."""
    found = baked(Mie(width=0.01, sun_disc=False).phase_bake())
    return {wavelength: {name: found[name][band] for name in ("moments", "asymmetry", "efficiency")}
            for band, wavelength in enumerate(droplets.BANDS)}


@pytest.mark.parametrize("wavelength", droplets.BANDS)
def test_equals_an_independent_evaluation(narrow: dict, wavelength: float) -> None:
    found, (g, efficiency, share, forward, backward, bow) = narrow[wavelength], COPIED[wavelength]
    assert found["asymmetry"] == pytest.approx(g, rel=1e-8)
    assert found["efficiency"] == pytest.approx(efficiency, rel=1e-8)
    assert share_within(found["moments"], np.radians(5)) == pytest.approx(share, abs=2e-3)
    ends = values_of(found["moments"], np.array([1.0, -1.0]))
    assert ends == pytest.approx([forward, backward], rel=3e-6)  # moments below 1e-9 are not kept
    rim = values_of(found["moments"], np.cos(np.radians(180 - np.array([38.0, 38.45, 38.8]))))
    assert rim.max() == pytest.approx(bow, rel=2e-2)


@pytest.mark.parametrize("wavelength", droplets.BANDS)
def test_fogbow_and_glory_stand_where_they_should(narrow: dict, wavelength: float) -> None:
    found, (fogbow, rings) = bows(narrow[wavelength]["moments"], SUN_RADIUS), RINGS[wavelength]
    assert np.degrees(found.fogbow) == pytest.approx(fogbow, abs=0.1)
    bright = np.degrees(found.glory)
    for ring in rings:
        assert np.abs(bright - ring).min() < 0.03


def test_whole_phase_functions_equal_the_reference_file() -> None:
    if not REFERENCE.is_file():
        assert COPIED  # the copied values are held above
        return
    known = np.load(REFERENCE)
    for distribution in ("normal", "lognormal"):
        sizes = droplets.Droplets(distribution=distribution)
        found = droplets.scattering(sizes, 650e-9, droplets.water_index(650e-9))
        values = values_of(found["moments"], np.cos(np.radians(known["angle_deg"])))
        assert values == pytest.approx(known[f"{distribution}_10pct_650nm_P"], rel=1e-6)


def test_the_integral_over_the_sphere_is_one(narrow: dict) -> None:
    nodes, weights = gauss(200)
    for found in narrow.values():
        values = values_of(found["moments"], nodes)
        assert 2 * np.pi * weights @ values == pytest.approx(1, abs=1e-9)
        assert values.min() > 0


def test_small_droplets_scatter_like_molecules() -> None:
    """Rayleigh's limit: P = 3 (1 + c^2) / (16 pi)."""
    found = droplets.scattering(droplets.Droplets(radius=1, width=0.01), 1e-4, 1.33 + 0j)
    cosines = np.linspace(-1, 1, 9)
    assert values_of(found["moments"], cosines) == pytest.approx(3 * (1 + cosines**2) / (16 * np.pi), rel=6e-3)


@pytest.mark.parametrize("distribution", ["normal", "lognormal", "gamma"])
def test_radii_have_the_mean_and_the_width(distribution: str) -> None:
    sizes, share = droplets.radii(droplets.Droplets(distribution=distribution, width=0.15))
    mean = share @ sizes
    assert share.sum() == pytest.approx(1)
    assert mean == pytest.approx(1e-5, rel=0.012)
    assert np.sqrt(share @ (sizes - mean) ** 2) / mean == pytest.approx(0.15, rel=0.08)


def test_a_convolution_squares_the_moments() -> None:
    """Two turns by Henyey and Greenstein's lobe are one with its mean cosine squared."""
    cosines = np.linspace(-1, 1, 41)
    moments = 0.6 ** np.arange(120)
    twice = (1 - 0.36**2) / (4 * np.pi) / (1 + 0.36**2 - 0.72 * cosines) ** 1.5
    assert values_of(moments**2, cosines) == pytest.approx(twice, rel=1e-9)
    nodes, weights = gauss(150)
    assert moments_of(values_of(moments, nodes), nodes, weights, 100) == pytest.approx(moments[:100], abs=1e-12)


def test_a_disc_is_spread_evenly() -> None:
    """Its mean cosine is that of its rim and its middle, (1 + cos) / 2."""
    assert disc_moments(3, 0.2)[:2] == pytest.approx([1, (1 + np.cos(0.2)) / 2])
    assert disc_moments(3, 0.0) == pytest.approx([1, 1, 1])
