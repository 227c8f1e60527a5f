"""How far every scattering technique is from photons in a plane cloud, and the thesis' own numbers beside computed
ones.

Truth are photons followed through the slab with the same phase function (`renderer.reference.cloud_slab`), which have
a known standard error; it is taken off the errors of radiance, as it is independent of what is judged.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from renderer.clouds.bows import bows
from renderer.clouds.droplets import BANDS, Droplets, scattering, water_index
from renderer.clouds.legendre import disc_moments, share_within, values_of
from renderer.clouds.measured_slab import evaluate, model_of
from renderer.clouds.phase_tables import FORWARD_ANGLE, SUN_RADIUS
from renderer.clouds.slab import Slab, SlabModel, first_up, second_up
from renderer.clouds.solving import solve
from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.registry import techniques
from renderer.core.technique import Arrays, Bake
from renderer.reference.cloud_photons import Scatterer
from renderer.reference.cloud_shell import SPACE, Shell, trace_shell
from renderer.reference.cloud_shell_single import chord, plane_single, sphere_single
from renderer.reference.cloud_slab import SlabPhotons, trace_slab

Tell = Callable[[float, str], None]

DEPTHS = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)
SUNS = (0.1, 0.2, 0.4, 0.7, 1.0)
BINS = (10, 6)
"""Of the cosine and the azimuth of leaving light."""

VIEWS = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99])
AZIMUTHS = np.radians(np.arange(13) * 15.0)
"""Directions in which techniques are held to the solver."""

SEED = 20_261_122
AUREOLE = np.radians(15.0)
"""Distance from the beam's direction within which bins are left out, rad."""

INNER = 4
"""Gauss nodes a side within a bin, over which a technique's radiance is averaged."""

ANGLES = np.radians(np.unique(np.concatenate([
    np.linspace(0, 15, 3001), np.linspace(15, 170, 3101), np.linspace(170, 180, 1001),
])))

BESIDE = np.radians(8.0)
"""Distance from the fogbow at which the cloud beside it is looked at, rad."""

RAYLEIGH = np.array([1.0, 0.0, 0.1])

HANSEN = Droplets(radius=5.6, width=1 / 3, distribution="gamma")
"""Effective radius 7 um, effective variance 0.1: the droplets of formulas a4's table."""


def bake_photons(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Tell) -> Arrays:
    """Photons through one slab, as a bake: counts by side, order and bin."""
    moments = np.array(arguments["moments"])
    scatterer = Scatterer.of(ANGLES, values_of(moments, np.cos(ANGLES)))
    depth, sun, count, seed = (arguments[name] for name in ("depth", "sun", "photons", "seed"))
    found = trace_slab(scatterer, depth, sun, count, seed, bins=BINS)
    return {"sides": np.stack([found.up, found.down]), "bins": np.stack([found.up_bins, found.down_bins])}


def photons(moments: np.ndarray, depth: float, sun: float, count: int, seed: int, cache: Cache) -> SlabPhotons:
    """The same, from the cache where it has them."""
    arguments = {"moments": moments.tolist(), "depth": depth, "sun": sun, "photons": count, "seed": seed}
    arrays = bake_now(Bake("slab_photons", bake_photons, arguments), cache)
    edges = np.linspace(0, 1, BINS[0] + 1), np.linspace(0, np.pi, BINS[1] + 1)
    (up, down), (up_bins, down_bins) = arrays["sides"], arrays["bins"]
    return SlabPhotons(count, up, down, up_bins, down_bins, *edges)


def binned(model: SlabModel, found: SlabPhotons, depth: float, sun: float, up: bool) -> np.ndarray:
    """A technique's radiance in the photons' bins, for each unit of irradiance on the level."""
    nodes, weights = np.polynomial.legendre.leggauss(INNER)
    inside, share = (nodes + 1) / 2, weights / 2
    cosine = found.cosine_edges[:-1, None] + np.diff(found.cosine_edges)[:, None] * inside
    azimuth = found.azimuth_edges[:-1, None] + np.diff(found.azimuth_edges)[:, None] * inside
    slab = Slab.between(np.array(depth), np.array(sun), cosine[:, None, :, None], azimuth[None, :, None, :], up)
    radiance = (model.up(slab) if up else model.down(slab))[..., 0] / sun
    projected = np.einsum("maij,mi,i,j->ma", radiance, cosine, share, share)
    mean: np.ndarray = projected / (cosine @ share)[:, None]
    return mean


def radiance_errors(model: SlabModel, found: SlabPhotons, depth: float, sun: float, up: bool) -> dict[str, float]:
    """Median of the relative error over the bins, and its root mean square over the mean without the photons' noise.

    Bins beside the sun are left out, and those that too few photons reached.
    """
    known, error = found.radiance(up, slice(1, None))
    off = binned(model, found, depth, sun, up) - known
    seen = (known > 4 * error) & ~beside_the_sun(found, sun, up)
    if not seen.any():
        return {"median": float("nan"), "noise": float("nan"), "rms": float("nan")}
    off, known, error = off[seen], known[seen], error[seen]
    square = max(float((off**2 - error**2).mean()), 0.0)
    return {"median": float(np.median(np.abs(off) / known)), "noise": float(np.median(error / known)),
            "rms": float(np.sqrt(square) / known.mean())}


def beside_the_sun(found: SlabPhotons, sun: float, up: bool) -> np.ndarray:
    """Bins (M, A) that come nearer than AUREOLE to the beam's direction: the peak there is narrower than they."""
    inside = np.linspace(0, 1, 9)
    cosine = (found.cosine_edges[:-1, None] + np.diff(found.cosine_edges)[:, None] * inside)[:, None, :, None]
    azimuth = (found.azimuth_edges[:-1, None] + np.diff(found.azimuth_edges)[:, None] * inside)[None, :, None, :]
    across = np.sqrt(1 - cosine**2) * np.sqrt(1 - sun**2) * np.cos(azimuth)
    beside: np.ndarray = (across + (-sun if up else sun) * cosine).max(axis=(2, 3)) > np.cos(AUREOLE)
    return beside


def technique_errors(count: int, cache: Cache, tell: Tell) -> list[dict[str, Any]]:
    """Every technique at every depth and sun: one line each, for droplets of 10 um, 10 % wide, at 650 nm."""
    moments = scattering(Droplets(), BANDS[0], water_index(BANDS[0]))["moments"]
    models = {kind: model_of(kind, moments) for kind in techniques("clouds", "scattering")}
    tell(0.0, "the solver")
    quiet = solver_errors(models, moments)
    lines = []
    for row, depth in enumerate(DEPTHS):
        for column, sun in enumerate(SUNS):
            tell((row * len(SUNS) + column) / len(DEPTHS) / len(SUNS), f"photons at depth {depth:g}, sun {sun:g}")
            found = photons(moments, depth, sun, count, SEED + 10 * row + column, cache)
            known, error = found.share(True)
            for kind, model in models.items():
                reflected = float(model.reflectance(np.array(depth), np.array(sun))[0])
                passed = float(model.transmittance(np.array(depth), np.array(sun))[0])
                lines.append({
                    "technique": kind, "depth": depth, "sun": sun, "photons": count, "seed": SEED + 10 * row + column,
                    "reflectance": reflected, "transmittance": passed, "truth": known, "standard_error": error,
                    "off_reflectance": reflected - known, "off_transmittance": passed - (1 - known),
                    "up": radiance_errors(model, found, depth, sun, True),
                    "down": radiance_errors(model, found, depth, sun, False),
                    "solver": quiet[kind][row, column].tolist(),
                })
    return lines


def solver_errors(models: Mapping[str, SlabModel], moments: np.ndarray) -> dict[str, np.ndarray]:
    """Error of each technique against the solver without tables, which has no noise.

    Returns:
        (T, S, 3) by kind: of reflectance, in shares of the beam; median relative error of radiance up and down over
        VIEWS and AZIMUTHS.
    """
    depths, suns = np.array(DEPTHS), np.array(SUNS)
    known = solve(moments, 1.0, depths, suns, VIEWS, AZIMUTHS)
    found = {}
    for kind, model in models.items():
        own = evaluate(model, depths, suns, VIEWS, AZIMUTHS)
        with np.errstate(divide="ignore", invalid="ignore"):
            medians = [np.median(np.abs(own[side] / known[side] - 1), axis=(2, 3)) for side in ("L_up", "L_down")]
        found[kind] = np.stack([np.abs(own["R"] - known["R"]), *medians], axis=-1)
    return found


def order_numbers(count: int, cache: Cache, tell: Tell) -> list[dict[str, Any]]:
    """Order 2 of the sunlit side: photons, the thesis' form and the corrected one, for the droplets of formulas a4."""
    moments = scattering(HANSEN, BANDS[0], water_index(BANDS[0]))["moments"]
    closed = model_of("orders", moments)
    lines = []
    for number, (sun, depth) in enumerate(((1.0, 0.5), (1.0, 1.0), (0.7, 2.0), (1.0, 4.0), (0.4, 8.0), (0.7, 32.0))):
        tell(number / 6, f"order 2 at depth {depth:g}, sun {sun:g}")
        found = photons(moments, depth, sun, count, SEED + 1000 + number, cache)
        one, two = (found.share(True, slice(order, order + 1)) for order in (1, 2))
        where = np.array(depth), np.array(sun)
        lines.append({"depth": depth, "sun": sun, "first": one, "second": two,
                      "first_form": float(closed.order_flux(0, *where)[0]),  # type: ignore[attr-defined]
                      "corrected": float(closed.order_flux(2, *where)[0]),  # type: ignore[attr-defined]
                      "thesis": _thesis_flux(moments, depth, sun)})
    return lines


def _thesis_flux(moments: np.ndarray, depth: float, sun: float) -> float:
    """Flux of order 2 with the factor of order 1, as printed, by quadrature over the hemisphere."""
    nodes, weights = np.polynomial.legendre.leggauss(160)
    view, azimuth = (nodes[:, None] + 1) / 2, (nodes + 1) * np.pi / 2
    slab = Slab.between(np.array(depth), np.array(sun), view, azimuth, True)
    radiance = values_of(moments**2, slab.cosine) * first_up(slab)
    return float(np.einsum("va,v,a->", radiance * view, weights / 2, weights * np.pi) / sun)


def lobe_numbers(count: int, cache: Cache, tell: Tell) -> list[dict[str, Any]]:
    """Radiance of order 2 over photons', Henyey-Greenstein 0.85, sun 0.7, view 0.6 to 0.7 (errata 001-16)."""
    moments = 0.85 ** np.arange(200)
    lines = []
    for number, (depth, printed, corrected) in enumerate((
        (0.05, 16.2, 0.59), (0.2, 5.3, 0.70), (0.5, 2.8, 0.79), (2.0, 1.81, 0.89), (8.0, 1.75, 0.88),
        (32.0, 1.76, 0.88),
    )):
        tell(number / 6, f"order 2 of a lobe at depth {depth:g}")
        # A thin layer scatters few photons twice, and costs as little.
        found = photons(moments, depth, 0.7, count * (16 if depth < 1 else 2), SEED + 2000 + number, cache)
        known = max(int(found.up_bins[2, 6].sum()), 1) / found.photons
        cosine = np.linspace(0.6, 0.7, 41)[:, None]
        slab = Slab.between(np.array(depth), np.array(0.7), cosine, (np.arange(360) + 0.5) * np.pi / 360, True)
        twice = values_of(moments**2, slab.cosine) * cosine / 0.7 * 2 * np.pi * 0.1
        lines.append({"depth": depth, "noise": float(1 / np.sqrt(max(known * found.photons, 1))),
                      "thesis": float((twice * first_up(slab)).mean() / known), "thesis_known": printed,
                      "corrected": float((twice * second_up(slab)).mean() / known), "corrected_known": corrected})
    return lines


def droplet_numbers(tell: Tell) -> list[dict[str, Any]]:
    """Share of the forward peak, fogbow and glory for droplets of 10 um of each distribution and band."""
    lines: list[dict[str, Any]] = []
    for width, distribution in ((0.01, "normal"), (0.1, "normal"), (0.1, "lognormal")):
        for wavelength in BANDS:
            tell(len(lines) / 9, f"{distribution} {width:g}, {1e9 * wavelength:.0f} nm")
            sizes = Droplets.model_validate({"width": width, "distribution": distribution})
            moments = scattering(sizes, wavelength, water_index(wavelength))["moments"]
            seen = bows(moments, SUN_RADIUS)
            lines.append({"distribution": distribution, "width": width, "nm": round(1e9 * wavelength),
                          "forward": share_within(moments, FORWARD_ANGLE), "g": float(moments[1]),
                          "fogbow": float(np.degrees(seen.fogbow)),
                          "glory": [float(np.degrees(ring)) for ring in seen.glory[:3]]})
    return lines


def contrast_numbers() -> list[dict[str, Any]]:
    """How far fogbow and glory stand out of order 1 with each phase function, at 650 nm, the sun's disc averaged.

    The bow against the mean of both sides, 8 degrees off; the first ring against the dark ring outside it.
    """
    mie = scattering(Droplets(), BANDS[0], water_index(BANDS[0]))["moments"]
    rings = bows(mie, SUN_RADIUS)
    away = np.array([rings.fogbow - BESIDE, rings.fogbow, rings.fogbow + BESIDE, rings.glory[0],
                     (rings.glory[0] + rings.glory[1]) / 2])
    lines = []
    for name, moments in (("mie", mie), ("henyey_greenstein", mie[1] ** np.arange(300)), ("rayleigh", RAYLEIGH)):
        inner, bow, outer, ring, dark = values_of(moments * disc_moments(len(moments), SUN_RADIUS), -np.cos(away))
        lines.append({"phase": name, "bow": float(2 * bow / (inner + outer)), "ring": float(ring / dark)})
    return lines


def path_numbers() -> list[dict[str, Any]]:
    """Length of a ray in a layer of 250 m at 2,500 m, in a plane and round the Earth, by its angle at the top."""
    shell = Shell(6.35e6, 2500.0, 250.0, 1.0)
    return [{"degrees": degrees, "plane": 250.0 / float(np.cos(np.radians(degrees))),
             "sphere": chord(shell, float(np.radians(degrees)))} for degrees in (0.0, 60.0, 85.0, 88.0, 89.0, 89.9)]


def sphere_numbers(count: int, tell: Tell) -> list[dict[str, Any]]:
    """Plane against sphere: order 1 at equal angles by quadrature, all orders by photons under a falling sun."""
    lines: list[dict[str, Any]] = []
    for extinction in (0.005, 0.04, 0.1):
        for degrees in (60.0, 85.0, 89.0):
            shell = Shell(6.35e6, 2500.0, 250.0, extinction)
            sphere, plane = (single(shell, *np.radians((degrees, degrees))) for single in (sphere_single, plane_single))
            lines.append({"kind": "single", "extinction": extinction, "degrees": degrees, "off": plane / sphere - 1})
    lobe = Scatterer.of(ANGLES, values_of(0.85 ** np.arange(200), np.cos(ANGLES)))
    for number, sun in enumerate((0.5, 0.1, 0.03, 0.01)):
        tell(number / 4, f"photons round the Earth, sun {sun:g}")
        shell = Shell(6.35e6, 2500.0, 100.0, 0.08)
        here = trace_shell(lobe, shell, sun, count, SEED + 3000 + number).share(SPACE)
        flat = trace_slab(lobe, 8.0, sun, count, SEED + 3100 + number).share(True)
        lines.append({"kind": "all", "sun": sun, "sphere": here, "plane": flat})
    return lines
