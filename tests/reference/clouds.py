"""Phase functions and reference values for the photons in clouds.

Reflectances are copied from `a_slab.npz` of the shared reference folder: PythonicDISORT, Henyey-Greenstein g = 0.85
(128 streams) and droplets of 10 um, 1 % wide, at 650 nm (384 streams); black ground.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from renderer.reference.cloud_photons import Scatterer

FILE = Path(__file__).parents[2].parent / "shared" / "reference" / "a_slab.npz"

DEPTHS = np.array([0.5, 2.0, 8.0, 32.0, 128.0])
SUNS = np.array([1.0, 0.7, 0.4, 0.1])
REFLECTANCE = {
    "HG": np.array([
        [0.01993, 0.0442, 0.12903, 0.47067],
        [0.09102, 0.17726, 0.34845, 0.61569],
        [0.35843, 0.47421, 0.60252, 0.76238],
        [0.7278, 0.77856, 0.83272, 0.89995],
        [0.9178, 0.93313, 0.94948, 0.96979],
    ]),
    "Mie": np.array([
        [0.02025, 0.04219, 0.11882, 0.43955],
        [0.08788, 0.16705, 0.33237, 0.60105],
        [0.33961, 0.45853, 0.59397, 0.75369],
        [0.71281, 0.76763, 0.82607, 0.89442],
        [0.91235, 0.92908, 0.94692, 0.96778],
    ]),
}
G = 0.85
ANGLES = np.radians(np.unique(np.concatenate([
    np.linspace(0, 15, 3001), np.linspace(15, 170, 3101), np.linspace(170, 180, 1001),
])))


def lobe(cosine: np.ndarray, g: float = G) -> np.ndarray:
    """Henyey and Greenstein's phase function, 1/sr."""
    return (1 - g**2) / (4 * np.pi) / (1 + g**2 - 2 * g * cosine) ** 1.5


def lobe_scatterer(g: float = G) -> Scatterer:
    """The same, to draw from."""
    return Scatterer.of(ANGLES, lobe(np.cos(ANGLES), g))


def moments_scatterer(moments: np.ndarray) -> Scatterer:
    """A phase function of given Legendre moments, to draw from."""
    degrees = np.arange(len(moments))
    values = np.polynomial.legendre.legval(np.cos(ANGLES), (2 * degrees + 1) / (4 * np.pi) * moments)
    return Scatterer.of(ANGLES, values)
