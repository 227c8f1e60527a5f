"""One isotropic Lafortune lobe for the leaves of a voxel: its formula, its fit and its bytes.

Lafortune, Foo, Torrance & Greenberg 1997; Cohen 2004, section 6.1 (errata 000-4: the formula, not the listing). With n
the leaves' mean normal on the eye's side, s the sun and v the eye, what is reflected is albedo / pi times

    a + max(s.n, 0) max(0, Cxy s.v + (Cz - Cxy) (s.n)(n.v))^p,

and what is let through is transmittance / pi times the same with -s for s: a thin sheet passes on across what it
reflects on one side.
"""

from __future__ import annotations

import functools
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import OptimizeResult, dual_annealing, least_squares

Floats = NDArray[Any]

THESIS = (0.86, 0.77, 0.5, 0.0)
"""Cxy, Cz, p and a of Cohen 2004, section 6.3."""

LEAST = np.array([-1.5, -1.5, 0.02, 0.0])
MOST = np.array([1.5, 1.5, 4.0, 0.5])
"""Range of Cxy, Cz, p and a that is fitted and stored; the thesis' own C end at 1.5 too."""

FITS = Path(__file__).with_name("lobe_fits.json")
"""Fitted coefficients with their recipe and residuals, as `umbrage leaves fit` writes them."""

STALLED = 0.02
"""Rise of the relative residual from one fit to the next above which a fit counts as stalled."""


def directions(count: int) -> Floats:
    """Directions spread evenly over the sphere: Fibonacci's spiral, (count, 3)."""
    n = np.arange(count) + 0.5
    z = 1 - 2 * n / count
    turn = n * np.pi * (1 + np.sqrt(5))
    return np.stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z], axis=1)


def leaves_reflect(kappa: Floats | float, lit: Floats, seen: Floats, cosine: Floats) -> Floats:
    """What leaves reflect, times pi over their albedo: thin sheets, a share kappa of them across the mean normal.

    Args:
        kappa: share. lit, seen: cosines of sun and eye to the mean normal. cosine: between sun and eye.

    Source: Ross 1981; `shaders/forest/light/leaf.glsl`.
    """
    between = np.arccos(np.clip(cosine, -1, 1))
    wild = (np.sin(between) + (np.pi - between) * cosine) / (3 * np.pi)
    shown = kappa * np.abs(seen) + (1 - kappa) / 2
    return (kappa * np.maximum(lit * seen, 0) + (1 - kappa) * wild) / np.maximum(shown, 1e-9)


def lobe(coefficients: NDArray, lit: Floats, seen: Floats, cosine: Floats) -> Floats:
    """What the lobe reflects, times pi over the albedo.

    Args:
        coefficients: Cxy, Cz, p, a in the last axis. lit, seen: cosines of sun and eye to the mean normal, which is
            turned to the eye's side. cosine: between sun and eye.
    """
    cxy, cz, power, even = np.moveaxis(np.asarray(coefficients, float), -1, 0)
    facing = np.where(seen < 0, -lit, lit)
    inner = cxy * cosine + (cz - cxy) * facing * np.abs(seen)
    return even + np.maximum(facing, 0) * np.where(inner > 0, np.maximum(inner, 1e-30) ** power, 0)


def pairs(views: int = 100, suns: int = 211) -> tuple[Floats, Floats, Floats]:
    """Cosines (lit, seen, between) of directions of sun and eye all round a normal, the eye on its side."""
    eye, sun = directions(2 * views)[:views], directions(suns)
    return np.tile(sun[:, 2], views), np.repeat(eye[:, 2], suns), (eye @ sun.T).ravel()


def relative_residual(found: Floats, wanted: Floats) -> float:
    """Root mean square of the difference over that of what is wanted."""
    return float(np.sqrt(np.mean((found - wanted) ** 2) / np.mean(wanted**2)))


def fit(wanted: Floats, at: tuple[Floats, Floats, Floats], start: NDArray, worst: float = np.inf) -> OptimizeResult:
    """Fit one lobe: least squares from a start; simulated annealing where that stalls.

    Args:
        wanted: values times pi over the albedo, at the cosines `at` (see `pairs`). start: coefficients to start from.
        worst: relative residual above which the fit counts as stalled.

    Returns:
        The better result: `x` coefficients, `residual` relative, `annealed` whether least squares had stalled.
    """
    bounds = (LEAST, MOST)

    def difference(coefficients: NDArray) -> Floats:
        return lobe(coefficients, *at) - wanted

    found = least_squares(difference, np.clip(start, LEAST + 1e-6, MOST - 1e-6), bounds=bounds)
    found.residual, found.annealed = relative_residual(lobe(found.x, *at), wanted), False
    if not found.success or found.residual > worst:
        cooled = dual_annealing(
            lambda c: float(np.sum(difference(c) ** 2)), list(zip(*bounds, strict=True)), maxiter=200, rng=1, x0=found.x
        )
        polished = least_squares(difference, np.clip(cooled.x, LEAST + 1e-6, MOST - 1e-6), bounds=bounds)
        polished.residual = relative_residual(lobe(polished.x, *at), wanted)
        if polished.residual <= found.residual:
            found = polished
        found.annealed = True
    return found


def fit_leaves(steps: int = 33) -> list[OptimizeResult]:
    """Lobes of leaves from all facing everywhere (kappa 0) to all alike (kappa 1), each fit starting from the last."""
    at = pairs()
    results: list[OptimizeResult] = []
    start, worst = np.array([0.97, 0.57, 1.0, 0.18]), np.inf
    for kappa in np.linspace(0, 1, steps):
        results.append(fit(leaves_reflect(kappa, *at), at, start, worst))
        start, worst = results[-1].x, results[-1].residual + STALLED
    return results


@functools.cache
def fitted() -> tuple[Floats, Floats]:
    """Kappa (n,) and the coefficients (n, 4) fitted there."""
    kept = json.loads(FITS.read_text())["lobes"]
    return np.array([row["kappa"] for row in kept]), np.array([row["coefficients"] for row in kept])


def coefficients_of(kappa: NDArray) -> Floats:
    """Fitted coefficients (.., 4) of leaves that agree as far as `kappa` (..)."""
    known, values = fitted()
    return np.stack([np.interp(kappa, known, values[:, n]) for n in range(4)], axis=-1)


def encode(coefficients: NDArray) -> NDArray[np.uint8]:
    """Coefficients (.., 4) in bytes over their range; the exponent by its root, which small ones need."""
    share = (coefficients - LEAST) / (MOST - LEAST)
    share[..., 2] = np.sqrt(np.maximum(share[..., 2], 0))
    result: NDArray[np.uint8] = np.rint(np.clip(share, 0, 1) * 255).astype(np.uint8)
    return result


def decode(stored: NDArray[np.uint8]) -> Floats:
    """Coefficients (.., 4) of bytes."""
    share = stored.astype(np.float64) / 255
    share[..., 2] **= 2
    return LEAST + share * (MOST - LEAST)
