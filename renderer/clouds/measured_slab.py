"""The quantity `slab`: what a plane cloud reflects and lets through, by any of the scattering techniques."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from renderer.clouds.droplets import Distribution, Droplets, scattering, water_index
from renderer.clouds.phase_tables import phase_arrays
from renderer.clouds.slab import Slab, SlabModel
from renderer.clouds.solving import NODES, solve
from renderer.clouds.technique import ScatteringTechnique
from renderer.core.errors import InputError, LimitError
from renderer.core.params import Model, param
from renderer.core.quantity import Progress, Quantity, Values
from renderer.core.registry import techniques

Depth = Annotated[float, Field(ge=0, le=256)]
Cosine = Annotated[float, Field(ge=0.005, le=1)]
Degrees = Annotated[float, Field(ge=-360, le=360)]
Albedo = Annotated[float, Field(ge=0, le=1)]

MOST = 2_000_000
"""Most radiances asked for at once."""

LAYERS = 100
"""Most layers that `doubling` solves at once, of as many directions as streams: about a minute."""

LOBE_MOMENTS = 600

Technique = Literal["doubling", "adding_doubling", "delta_eddington", "orders", "single", "thesis_orders"]


class SlabArguments(Model):
    """A plane layer, the directions of sun and view, and how it is solved."""

    optical_depths: Annotated[tuple[Depth, ...], Field(min_length=1, max_length=64)] = param(
        (0.5, 2.0, 8.0, 32.0, 128.0), label="Optical depths", help="Along the normal.", cost="host"
    )
    albedos: Annotated[tuple[Albedo, ...], Field(min_length=1, max_length=8)] = param(
        (1.0,),
        label="Single-scattering albedos",
        help="Share of a meeting that is scattered; below 1 by `doubling` alone.",
        cost="host",
    )
    sun_cosines: Annotated[tuple[Cosine, ...], Field(min_length=1, max_length=64)] = param(
        (1.0, 0.7, 0.4, 0.1), label="Sun", help="Cosines of its zenith angle.", cost="host"
    )
    view_cosines: Annotated[tuple[Cosine, ...], Field(min_length=1, max_length=64)] = param(
        (*(round(0.05 * step, 2) for step in range(1, 20)), 0.99),
        label="View",
        help="Cosines of the leaving light to the normal.",
        cost="host",
    )
    azimuths: Annotated[tuple[Degrees, ...], Field(min_length=1, max_length=64)] = param(
        tuple(15.0 * step for step in range(13)),
        label="Azimuths",
        help="Of the leaving light against the beam's own direction: 0 = forward, in degrees.",
        cost="host",
    )
    phase: Literal["mie", "henyey_greenstein", "rayleigh"] = param(
        "mie", label="Phase function", help="Where a droplet sends light.", cost="host"
    )
    asymmetry: float = param(
        0.85, label="Mean cosine", help="Of Henyey and Greenstein's lobe.", unit="ratio", cost="host", ge=0, le=0.97
    )
    radius: float = param(
        10.0, label="Droplet radius", help="Of Mie's phase function.", unit="um", cost="host", ge=0.1, le=30
    )
    distribution: Distribution = param("normal", label="Distribution", help="Of the droplets' radii.", cost="host")
    width: float = param(
        0.1,
        label="Width",
        help="Standard deviation of the radii over their mean.",
        unit="ratio",
        cost="host",
        ge=0.005,
        le=0.5,
    )
    wavelength: Annotated[float, Field(ge=400, le=700)] = param(
        650.0, label="Wavelength", help="Of Mie's phase function, in nanometres.", cost="host"
    )
    technique: Technique = param(
        "adding_doubling",
        label="Technique",
        help="One of the slot `scattering`, or `doubling`: the solver without tables.",
        cost="host",
    )


def phase_moments(given: SlabArguments) -> np.ndarray:
    """Legendre moments of the phase function asked for."""
    if given.phase == "henyey_greenstein":
        with np.errstate(under="ignore"):
            moments = given.asymmetry ** np.arange(LOBE_MOMENTS, dtype=np.float64)
        return moments[: max(int((moments > 1e-12).sum()), 2)]
    if given.phase == "rayleigh":
        return np.array([1.0, 0.0, 0.1])
    sizes = Droplets.model_construct(radius=given.radius, distribution=given.distribution, width=given.width)
    wavelength = given.wavelength * 1e-9
    return scattering(sizes, wavelength, water_index(wavelength))["moments"]


def model_of(kind: str, moments: np.ndarray) -> SlabModel:
    """A technique's numpy twin for a phase function of one band."""
    technique = techniques("clouds", "scattering")[kind]()
    assert isinstance(technique, ScatteringTechnique)
    arrays: dict[str, Mapping[str, np.ndarray]] = {"phase": phase_arrays(np.tile(moments, (3, 1)))}
    nobody = SimpleNamespace(phase=SimpleNamespace(phase_bake=lambda: None))
    for bake in technique.bakes(nobody):
        arrays[bake.name] = bake.function(bake.arguments, {"phase": arrays["phase"]}, lambda share, words: None)
    return technique.model(arrays)


def evaluate(model: SlabModel, depths: np.ndarray, suns: np.ndarray, views: np.ndarray, azimuths: np.ndarray) -> dict:
    """What a technique says at the same grid as `solving.solve`, in the first band."""
    found = {
        "R": model.reflectance(depths[:, None], suns)[..., 0],
        "T_total": model.transmittance(depths[:, None], suns)[..., 0],
    }
    for up, name in ((True, "L_up"), (False, "L_down")):
        slab = Slab.between(depths[:, None, None, None], suns[:, None, None], views[:, None], azimuths, up)
        found[name] = (model.up(slab) if up else model.down(slab))[..., 0]
    return found


def _slab(arguments: SlabArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    given = arguments
    depths, suns, views = (np.array(a) for a in (given.optical_depths, given.sun_cosines, given.view_cosines))
    azimuths = np.radians(given.azimuths)
    count = len(depths) * len(suns) * len(views) * len(azimuths) * len(given.albedos)
    if count > MOST:
        raise LimitError("azimuths", f"{count:,} radiances in all", f"at most {MOST:,}")
    heavy = len(depths) * len(given.albedos) * ((NODES + len(suns) + len(views)) / 2 / NODES) ** 3
    if given.technique == "doubling" and heavy > LAYERS:
        raise LimitError(
            "optical_depths",
            f"work for {heavy:.0f} layers in as many directions as streams",
            f"at most {LAYERS}; fewer depths, suns or views",
        )
    if given.technique != "doubling" and any(albedo < 1 for albedo in given.albedos):
        raise InputError(
            "albedos", f"{given.technique} is for droplets that absorb nothing", "1, or the technique doubling"
        )
    moments = phase_moments(given)
    found = []
    for number, albedo in enumerate(given.albedos):
        progress(number / len(given.albedos), f"single-scattering albedo {albedo:g}")
        if given.technique == "doubling":
            found.append(solve(moments, albedo, depths, suns, views, azimuths))
        else:
            found.append(evaluate(model_of(given.technique, moments), depths, suns, views, azimuths))
    # One phase function; then albedo, depth, sun (, view, azimuth); radiance for irradiance on the level.
    arrays = {name: np.stack([one[name] for one in found])[None] for name in ("R", "T_total")}
    direct = np.exp(-depths[:, None] / suns)
    arrays["T_direct"] = np.broadcast_to(direct, arrays["R"].shape).copy()
    for name in ("L_up", "L_down"):
        arrays[name] = np.stack([one[name] / suns[:, None, None] for one in found])[None]
    arrays |= {
        "omega": np.array(given.albedos),
        "tau": depths,
        "mu0": suns,
        "mu_view": views,
        "phi_deg": np.array(given.azimuths),
        "leg": moments,
    }
    names = {
        "mie": f"Mie, {given.distribution} {given.radius:g} um, {100 * given.width:g} %, {given.wavelength:g} nm",
        "henyey_greenstein": f"Henyey-Greenstein, g = {given.asymmetry:g}",
        "rayleigh": "Rayleigh",
    }
    notes = (
        names[given.phase],
        f"technique: {given.technique}",
        "black ground, no sky; the beam brings an irradiance of 1 to the level",
    )
    return Values(arrays, notes)


AXES = "[phase, omega, tau, mu0]"

SLAB = Quantity(
    title="Plane cloud",
    help="What a plane cloud reflects and lets through, in all and by direction, by any scattering technique.",
    arguments=SlabArguments,
    function=_slab,
    units={
        "R, T_total, T_direct": f"share of the beam; {AXES}, T_total with T_direct in it",
        "L_up": f"1/sr, radiance upwards at the top for each unit of irradiance on the level; {AXES[:-1]}, mu_view, "
        f"phi]",
        "L_down": "the same downwards at the base, without the direct beam",
        "omega": "single-scattering albedo",
        "tau": "optical depth along the normal",
        "mu0, mu_view": "cosines to the normal, positive",
        "phi_deg": "degrees between the azimuths of the leaving light and of the beam's direction; 0 = forward",
        "leg": "Legendre moments of the phase function, the first being 1",
    },
    technique="as asked: adding_doubling (tables that the shaders read), doubling (without tables, 32 streams a "
    "side, also with "
    "absorption), delta_eddington, orders, thesis_orders, single",
    source="van de Hulst 1963; Wiscombe 1977; Nakajima and Tanaka 1988; Joseph, Wiscombe and Weinman 1976; Blinn 1982; "
    "Belcour 2009",
    error={
        "doubling": "R, T 1e-4 relative; L_up 0.1 % median, 3.5 % at worst (glory); L_down 0.1 % median, 6 % at worst "
                    "(aureole of thin layers)",
        "adding_doubling": "R, T 0.2 % relative for tau 0.5 to 128; L_up 0.8 % median, L_down 2 % (4 % of a wide lobe)",
        "delta_eddington": "R, T 0.04 of the beam, 0.1 at mu0 = 0.1; radiance half of itself in the darkest directions",
        "orders": "R, T 0.008 of the beam for mu0 from 0.4, 0.09 at 0.1; radiance half of itself in the darkest "
        "directions",
        "thesis_orders": "R, T 0.06 of the beam for mu0 from 0.4, 0.17 at 0.1; order 2 twice too bright: the "
        "technique's own",
        "single": "all that is scattered twice and more is missing: the technique's own",
    },
)
"""The quantity `slab`."""
