"""Light scattered by the droplets of a cloud: Mie's series, over a distribution of radii (Mie 1908; Wiscombe 1980).

Each droplet's coefficients come from miepython. Its intensity is a polynomial of the cosine, of twice the series'
degree, so that a Gauss-Legendre quadrature of enough nodes gives exact moments, and these give the phase function at
any angle.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Literal

import numpy as np
from miepython import an_bn

from renderer.clouds.legendre import gauss, moments_of
from renderer.core.errors import InputError
from renderer.core.params import Model, param
from renderer.core.technique import Arrays

Distribution = Literal["normal", "lognormal", "gamma"]
Progress = Callable[[float, str], None]

BANDS = (650e-9, 550e-9, 450e-9)
"""Wavelengths of red, green and blue, m."""

INDICES: Mapping[float, complex] = {
    400e-9: 1.339 - 1.86e-9j,
    425e-9: 1.338 - 1.30e-9j,
    450e-9: 1.337 - 1.02e-9j,
    475e-9: 1.336 - 9.35e-10j,
    500e-9: 1.335 - 1.00e-9j,
    525e-9: 1.334 - 1.32e-9j,
    550e-9: 1.333 - 1.96e-9j,
    575e-9: 1.333 - 3.60e-9j,
    600e-9: 1.332 - 1.09e-8j,
    625e-9: 1.332 - 1.39e-8j,
    650e-9: 1.331 - 1.64e-8j,
    675e-9: 1.331 - 2.23e-8j,
    700e-9: 1.331 - 3.35e-8j,
}
"""Refractive index of water by wavelength [m] (Hale & Querry 1973)."""

REACH = 4.0
"""Standard deviations of the distribution on each side that are counted."""

NARROW = 0.02
"""Width up to which `FEW` radii are enough: a step of 0.05 in the size parameter of 10 um at 450 nm."""

FEW, MANY = 241, 961
"""Radii of a distribution. The sharpest resonances fall between them: 1e-4 of the light."""


class Droplets(Model):
    """Sizes of the droplets of a cloud."""

    radius: float = param(
        10.0,
        label="Droplet radius",
        help="Mean radius; the median of a lognormal distribution.",
        unit="um",
        cost="bake",
        ge=1,
        le=30,
        source="Belcour 2009, figure 2.5 (errata 001-23)",
    )
    distribution: Distribution = param(
        "normal", label="Distribution", help="How the number of droplets spreads over radii.", cost="bake"
    )
    width: float = param(
        0.1,
        label="Width",
        help="Standard deviation over the mean; of a lognormal distribution, exp of that of the logarithm, less 1.",
        unit="ratio",
        cost="bake",
        ge=0.005,
        le=0.5,
    )


def water_index(wavelength: float) -> complex:
    """Refractive index of water between the tabulated wavelengths [m], absorption negative.

    Raises:
        InputError: a wavelength outside the table.
    """
    known = np.array(sorted(INDICES))
    if not known[0] * (1 - 1e-9) <= wavelength <= known[-1] * (1 + 1e-9):
        raise InputError("wavelengths", "outside the table of water's index", "400 to 700 nm, or an index of its own")
    real = np.interp(wavelength, known, [INDICES[w].real for w in known])
    lost = np.interp(wavelength, known, [-INDICES[w].imag for w in known])
    return complex(real, -lost)


def radii(droplets: Droplets) -> tuple[np.ndarray, np.ndarray]:
    """Radii [m] and the share of droplets that each stands for."""
    mean, width = droplets.radius * 1e-6, droplets.width
    if droplets.distribution == "lognormal":
        spread = np.log1p(width)
        low, high = mean * np.exp(-REACH * spread), mean * np.exp(REACH * spread)
    else:
        # A gamma distribution has a longer tail than a normal one.
        reach = REACH if droplets.distribution == "normal" else REACH * (1 + width)
        low, high = mean * max(1 - REACH * width, 0.02), mean * (1 + reach * width)
    count = FEW if width <= NARROW else MANY
    sizes = np.geomspace(low, high, count) if droplets.distribution == "lognormal" else np.linspace(low, high, count)
    if droplets.distribution == "normal":
        number = np.exp(-((sizes - mean) ** 2) / (2 * (width * mean) ** 2))
    elif droplets.distribution == "lognormal":
        number = np.exp(-(np.log(sizes / mean) ** 2) / (2 * np.log1p(width) ** 2))  # even steps of the logarithm
    else:
        shape = width**-2
        exponent = (shape - 1) * np.log(sizes / mean) - shape * (sizes / mean - 1)
        number = np.exp(exponent - exponent.max())
    return sizes, number / number.sum()


def scattering(droplets: Droplets, wavelength: float, index: complex) -> dict[str, np.ndarray]:
    """Optics of a distribution of droplets at one wavelength.

    Args:
        droplets: their sizes.
        wavelength: m. index: of water, absorption negative.

    Returns:
        `moments` (L,) of the phase function (whose integral over the sphere is 1), and scalars: `efficiency` and
        `scattering_efficiency` (cross-section over geometric section), `albedo` of single scattering, `asymmetry`,
        `effective_radius_m`.
    """
    sizes, share = radii(droplets)
    k = 2 * np.pi / wavelength
    series = [an_bn(index, k * size) for size in sizes]
    terms = max(len(a) for a, _ in series)
    a, b = np.zeros((2, len(sizes), terms), complex)
    for row, (first, second) in enumerate(series):
        a[row, : len(first)], b[row, : len(second)] = first, second
    orders = np.arange(1, terms + 1)
    extinction = share @ (2 * np.pi / k**2 * ((2 * orders + 1) * (a + b).real).sum(axis=1))
    scattered = share @ (2 * np.pi / k**2 * ((2 * orders + 1) * (abs(a) ** 2 + abs(b) ** 2)).sum(axis=1))
    section = share @ (np.pi * sizes**2)
    nodes, weights = gauss(2 * terms + 2)
    intensity = _intensity(a, b, nodes, share)
    moments = moments_of(intensity / k**2 / scattered, nodes, weights, 2 * terms + 1)
    return {
        "moments": moments / moments[0],
        "efficiency": np.asarray(extinction / section),
        "scattering_efficiency": np.asarray(scattered / section),
        "albedo": np.asarray(scattered / extinction),
        "asymmetry": np.asarray(moments[1] / moments[0]),
        "effective_radius_m": np.asarray((share @ sizes**3) / (share @ sizes**2)),
    }


def _intensity(a: np.ndarray, b: np.ndarray, cosines: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Mean over droplets of (|S1|^2 + |S2|^2) / 2 at cosines (K,): Bohren & Huffman 1983, equations 4.74."""
    terms = a.shape[1]
    pi, tau = np.zeros((2, terms, len(cosines)))
    before, now = np.zeros_like(cosines), np.ones_like(cosines)
    for n in range(1, terms + 1):
        pi[n - 1] = now
        tau[n - 1] = n * cosines * now - (n + 1) * before
        before, now = now, ((2 * n + 1) * cosines * now - (n + 1) * before) / n
    scale = (2 * np.arange(1, terms + 1) + 1) / (np.arange(1, terms + 1) * np.arange(2, terms + 2))
    total = np.zeros_like(cosines)
    for start in range(0, len(share), 128):
        part = slice(start, start + 128)
        # Real and imaginary parts apart: a product of complex with real arrays would make all of it complex.
        rows = np.stack([a[part].real, a[part].imag, b[part].real, b[part].imag]) * scale
        by_pi, by_tau = rows @ pi, rows @ tau
        first, second = by_pi[:2] + by_tau[2:], by_tau[:2] + by_pi[2:]
        total += share[part] @ (first**2 + second**2).sum(axis=0) / 2
    return total


def band_scattering(arguments: Mapping[str, Any], progress: Progress) -> Arrays:
    """`scattering` in each of the bands, moments padded with zeros to one length; arguments of `Droplets`."""
    droplets = Droplets(**arguments)
    found = []
    for number, wavelength in enumerate(BANDS):
        progress(number / len(BANDS), "light scattered by droplets")
        found.append(scattering(droplets, wavelength, water_index(wavelength)))
    longest = max(len(one["moments"]) for one in found)
    moments = np.stack([np.pad(one["moments"], (0, longest - len(one["moments"]))) for one in found])
    return {name: moments if name == "moments" else np.stack([one[name] for one in found]) for name in found[0]}
