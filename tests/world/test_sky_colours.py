"""Three bands shown as red, green and blue against a spectrum: how far the colours of sun and sky are off."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.world import atmosphere
from renderer.world.sky import bake_sky

WAVELENGTHS = np.linspace(400.0, 720.0, 18)
"""In nm, six bakes of three."""

OZONE = (
    (400, 0.02), (440, 0.16), (480, 0.78), (500, 1.48), (520, 2.14), (540, 3.09), (560, 4.27), (580, 4.40), (600, 5.02),
    (620, 3.74), (640, 2.66), (660, 1.85), (680, 1.21), (700, 0.75), (720, 0.51),
)  # fmt: skip
"""Absorption cross section of ozone, 1e-25 m² at nm (Bruneton 2017, after Serdyuchenko et al. 2014), in 20 to 40 nm."""

DENSEST = 300 * 2.687e20 / 15e3
"""Molecules of ozone in a m³ where it is densest: 300 Dobson units in a triangle of 30 km."""


def observer() -> np.ndarray:
    """What each wavelength of sunlight adds to linear sRGB, (3, wavelengths), rows of sum one: the sun above the air is
    white (Wyman, Sloan and Shirley 2013, section 2.2; its spectrum as a black body of 5772 K)."""

    def lobe(scale: float, middle: float, below: float, above: float) -> np.ndarray:
        apart = WAVELENGTHS - middle
        return scale * np.exp(-0.5 * (apart * np.where(apart < 0, below, above)) ** 2)

    x = lobe(1.056, 599.8, 0.0264, 0.0323) + lobe(0.362, 442.0, 0.0624, 0.0374) + lobe(-0.065, 501.1, 0.0490, 0.0382)
    y = lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322)
    z = lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725)
    srgb = [[3.2405, -1.5371, -0.4985], [-0.9693, 1.8760, 0.0416], [0.0556, -0.2040, 1.0572]]
    seen = np.array(srgb) @ np.stack([x, y, z]) / (WAVELENGTHS**5 * np.expm1(1.4388e7 / (WAVELENGTHS * 5772.0)))
    return np.asarray(seen / seen.sum(axis=1, keepdims=True))


def light(haze: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Elevations of the sun in degrees, and what sun and sky send, (elevations, bands)."""
    tables = bake_sky({"haze": haze}, {}, lambda share, words: None)
    return np.degrees(tables["elevations"]), tables["sun_irradiance"], tables["sky_irradiance"]


@pytest.mark.slow
@pytest.mark.parametrize(("haze", "low", "high"), [(1.0, 0.86, 0.92), (20.0, 0.97, 1.03)])
def test_colours_of_the_day_are_those_of_a_spectrum(
    monkeypatch: pytest.MonkeyPatch, haze: float, low: float, high: float
) -> None:
    elevations, sun, sky = light(haze)
    cross_section = np.interp(WAVELENGTHS, *np.transpose(OZONE))
    parts = []
    for three in np.split(np.arange(len(WAVELENGTHS)), 6):
        monkeypatch.setattr(atmosphere, "RAYLEIGH", 13.558e-3 * (550.0 / WAVELENGTHS[three]) ** 4.08)
        monkeypatch.setattr(atmosphere, "OZONE", 1e-25 * cross_section[three] * DENSEST * 1e3)
        parts.append(light(haze)[1:])
    spectral = [np.concatenate(found, axis=1) @ observer().T for found in zip(*parts, strict=True)]
    for degrees, redder in ((45.0, 1.05), (10.0, 1.19)):
        at = int(np.argmin(np.abs(elevations - degrees)))
        of_sun, of_sky = (
            banded[at] / banded[at, 1] * full[at, 1] / full[at]
            for banded, full in zip((sun, sky), spectral, strict=True)
        )
        assert of_sun[0] == pytest.approx(redder, abs=0.03)
        assert of_sun[2] == pytest.approx(1.0, abs=0.04)
        assert of_sky[2] == pytest.approx(1.0, abs=0.04)
        assert degrees < 45.0 or low < of_sky[0] < high
