"""Photons in a spherical shell: closed forms of the beam, the plane as a limit, and both crossings."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.reference.cloud_photons import Scatterer
from renderer.reference.cloud_shell import GROUND, SPACE, Shell, trace_shell
from renderer.reference.cloud_slab import trace_slab
from tests.reference import clouds

SEED = 4_203_138
"""Fixed before any result was seen."""

THIN = Shell(radius=6.35e6, base=2500.0, thickness=100.0, extinction=1e-4)
CLOUD = Shell(radius=6.35e6, base=2500.0, thickness=100.0, extinction=0.08)


@pytest.fixture(scope="module")
def lobe() -> Scatterer:
    return clouds.lobe_scatterer()


def chord(shell: Shell, mu: float) -> tuple[float, bool]:
    """Length m of a ray through the shell, both crossings together, and whether it meets the Earth."""
    inner = shell.radius + shell.base
    outer = inner + shell.thickness
    inside = np.sqrt(np.clip(inner**2 - outer**2 * (1 - mu**2), 0, None))
    once = outer * mu - inside
    meets = shell.radius**2 > outer**2 * (1 - mu**2)
    return (once if meets else 2 * once), bool(meets)


@pytest.mark.parametrize("mu", [0.5, 0.03, 0.02, 0.004])
def test_the_beam_has_the_length_of_its_chords(lobe: Scatterer, mu: float) -> None:
    length, meets = chord(THIN, mu)
    found = trace_shell(lobe, THIN, mu, 40_000, SEED)
    share, error = found.share(GROUND if meets else SPACE, slice(0, 1))
    assert abs(share - np.exp(-THIN.extinction * length)) < 4 * error
    assert found.share(SPACE if meets else GROUND, slice(0, 1))[0] == 0
    assert (found.gaps > 0.2 * found.photons) == (not meets and mu > 0.01)


@pytest.mark.parametrize("mu", [1.0, 0.4, 0.1])
def test_a_high_sun_sees_a_plane(lobe: Scatterer, mu: float) -> None:
    here, error = trace_shell(lobe, CLOUD, mu, 40_000, SEED).share(SPACE)
    flat, error_of_flat = trace_slab(lobe, 8.0, mu, 40_000, SEED + 1).share(True)
    assert abs(here - flat) < 4 * np.hypot(error, error_of_flat)


def test_a_small_planet_is_no_plane(lobe: Scatterer) -> None:
    """Under a grazing sun a layer a tenth as thick as its planet lets a share of the light out again at the other
    side."""
    small = Shell(radius=1000.0, base=10.0, thickness=100.0, extinction=0.08)
    here, error = trace_shell(lobe, small, 0.1, 20_000, SEED).share(SPACE)
    assert abs(here - clouds.REFLECTANCE["HG"][2, 3]) > 8 * error


def test_every_photon_ends_once(lobe: Scatterer) -> None:
    found = trace_shell(lobe, CLOUD, 0.3, 20_000, SEED)
    assert found.ended.sum() == found.photons
    assert found.leaving.sum() == found.ended[SPACE, 1:].sum()
    assert (found.rising <= found.leaving).all()
    assert np.array_equal(found.ended, trace_shell(lobe, CLOUD, 0.3, 20_000, SEED, threads=1).ended)
