"""The quantity `mie`: light scattered by a distribution of water droplets."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from renderer.clouds.bows import bows
from renderer.clouds.droplets import Distribution, Droplets, radii, scattering, water_index
from renderer.clouds.legendre import share_within, values_of
from renderer.clouds.phase_tables import FORWARD_ANGLE, SUN_RADIUS
from renderer.core.errors import InputError, LimitError
from renderer.core.params import Model, param
from renderer.core.quantity import Progress, Quantity, Values

Nanometres = Annotated[float, Field(ge=100, le=20_000)]
Index = tuple[Annotated[float, Field(ge=0.1, le=10)], Annotated[float, Field(ge=0, le=10)]]

LARGEST = 1300
"""Largest size parameter, circumference over wavelength: a minute of one core for each wavelength."""

MOMENTS = 600
"""Legendre moments given; those beyond the series are 0."""


class MieArguments(Model):
    """A distribution of droplets, and the light that meets them."""

    radius: float = param(
        10.0,
        label="Droplet radius",
        help="Mean radius; the median of a lognormal distribution.",
        unit="um",
        cost="host",
        ge=0.05,
        le=50,
    )
    distribution: Distribution = param(
        "normal", label="Distribution", help="How the number of droplets spreads over radii.", cost="host"
    )
    width: float = param(
        0.1,
        label="Width",
        help="Standard deviation over the mean; of a lognormal distribution, exp of that of the logarithm, less 1.",
        unit="ratio",
        cost="host",
        ge=0.005,
        le=0.5,
    )
    wavelengths: Annotated[tuple[Nanometres, ...], Field(min_length=1, max_length=16)] = param(
        (450.0, 550.0, 650.0), label="Wavelengths", help="In vacuum, in nanometres.", cost="host"
    )
    indices: Annotated[tuple[Index, ...], Field(max_length=16)] = param(
        (),
        label="Refractive indices",
        help="Real part, and absorbing part as a positive number, for each "
        "wavelength; those of "
        "water where none is given.",
        cost="host",
    )


def angles_deg() -> np.ndarray:
    """Angles at which the phase function is given, dense at both ends, degrees."""
    return np.concatenate([np.arange(250) * 0.02, 5 + np.arange(500) * 0.25, 130 + np.arange(1001) * 0.05])


def _mie(arguments: MieArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    given = arguments
    if given.indices and len(given.indices) != len(given.wavelengths):
        raise InputError("indices", "not one for each wavelength", f"{len(given.wavelengths)} pairs, or none for water")
    sizes = Droplets.model_construct(radius=given.radius, distribution=given.distribution, width=given.width)
    largest = 2 * np.pi * radii(sizes)[0][-1] / (min(given.wavelengths) * 1e-9)
    if largest > LARGEST:
        raise LimitError("radius", f"its largest droplets have a size parameter of {largest:.0f}",
                         f"at most {LARGEST}: smaller or more equal droplets, or longer waves")
    angles = angles_deg()
    arrays: dict[str, np.ndarray] = {"angle_deg": angles, "wavelength_nm": np.array(given.wavelengths)}
    columns: dict[str, list[float]] = {}
    for number, wavelength in enumerate(given.wavelengths):
        progress(number / len(given.wavelengths), f"{wavelength:g} nm")
        index = (
            complex(given.indices[number][0], -given.indices[number][1])
            if given.indices
            else (water_index(wavelength * 1e-9))
        )
        found = scattering(sizes, wavelength * 1e-9, index)
        moments = found["moments"]
        name = f"{given.distribution}_{round(100 * given.width):02d}pct_{wavelength:g}nm"
        arrays[f"{name}_P"] = values_of(moments, np.cos(np.radians(angles)))
        arrays[f"{name}_leg"] = np.pad(moments, (0, max(MOMENTS - len(moments), 0)))[:MOMENTS]
        seen = bows(moments, SUN_RADIUS)
        arrays[f"{name}_glory_deg"] = np.degrees(np.array(seen.glory))
        for column, value in (
            ("refractive_index", index.real),
            ("absorbing_index", -index.imag),
            ("g", found["asymmetry"]),
            ("Qext", found["efficiency"]),
            ("Qsca", found["scattering_efficiency"]),
            ("ssa", found["albedo"]),
            ("effective_radius_um", 1e6 * found["effective_radius_m"]),
            ("forward_5deg", share_within(moments, FORWARD_ANGLE)),
            ("fogbow_deg", np.degrees(seen.fogbow)),
        ):
            columns.setdefault(column, []).append(float(value))
    arrays |= {name: np.array(values) for name, values in columns.items()}
    notes = (
        "phase functions are unpolarised means weighted by scattering cross-section, integral over the sphere 1",
        "fogbow and glory: angle from the antisolar point, averaged over the sun's disc of 0.533 degrees",
    )
    return Values(arrays, notes)


MIE = Quantity(
    title="Scattering by droplets",
    help="Phase function, Legendre moments, asymmetry and efficiencies of a distribution of water droplets.",
    arguments=MieArguments,
    function=_mie,
    units={
        "angle_deg": "degrees, scattering angle",
        "wavelength_nm": "nm",
        "*_P": "1/sr, by angle; integral over the sphere 1",
        "*_leg": "Legendre moments, the first being 1, not weighted by 2 l + 1",
        "*_glory_deg": "degrees from the antisolar point, bright rings from the inside",
        "refractive_index, absorbing_index": "ratio, by wavelength",
        "g": "mean cosine of the scattering angle, by wavelength",
        "Qext, Qsca": "cross-sections over the geometric section, by wavelength",
        "ssa": "share of a meeting that is scattered, by wavelength",
        "effective_radius_um": "um, third moment of the radius over the second",
        "forward_5deg": "share scattered by less than 5 degrees, by wavelength",
        "fogbow_deg": "degrees from the antisolar point, by wavelength",
    },
    technique="Mie series of each radius (miepython), moments by Gauss-Legendre quadrature over the cosine",
    source="Mie 1908; Wiscombe 1980; water: Hale and Querry 1973",
    error={
        "*_P": "1e-9 relative for the sampled radii; sharp resonances between these move it by up to 2 % behind 150 "
        "degrees",
        "*_leg": "1e-10; from the sampling of radii 2e-4",
        "g, Qext, Qsca": "1e-8; from the sampling of radii 2e-4",
    },
)
"""The quantity `mie`."""
