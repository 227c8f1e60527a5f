"""Where techniques of a plane layer fail: the numbers and charts of their cases."""

from __future__ import annotations

import numpy as np

from renderer import slab_study as study
from renderer.clouds.droplets import BANDS, Droplets, scattering, water_index
from renderer.clouds.geometry.flat import Flat
from renderer.clouds.geometry.sphere import Sphere
from renderer.clouds.geometry.sphere_naive import SphereNaive
from renderer.clouds.measured_slab import model_of
from renderer.clouds.solving import solve
from renderer.core.cache import Cache
from renderer.core.failure import Charted, Curve, Part
from renderer.reference.cloud_shell import Shell
from renderer.reference.cloud_shell_single import chord

RADIUS, BASE = 6.35e6, 2500.0
PARTS: tuple[Part, Part] = ("failing", "surviving")
PHOTONS = 100_000
"""Of each slab in which light scattered twice is counted: 2 % of it."""

LOW = 0.1
"""Angle above the horizontal at which the plane's way is held to the shell's, degrees."""


def plane_at_the_horizon() -> Charted:
    """Thickness over cosine, and the sphere's closed form in float32, against the chord of a shell."""
    shell = Shell(RADIUS, BASE, 250.0, 1.0)
    up = np.geomspace(0.02, 30.0, 60)  # degrees above the horizontal of the base
    flat, sphere, truth = _ways(np.sin(np.radians(up)), shell)
    wrong, right = (float(np.interp(LOW, up, np.abs(found / truth - 1))) for found in (flat, sphere))
    curves = (Curve("truth", up, truth), Curve("failing", up, flat), Curve("surviving", up, sphere))
    return Charted(wrong, right, curves, "angle of the ray above the horizontal of the base, degrees", "way, m", "xy")


def _ways(mu: np.ndarray, shell: Shell) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Flat, on the sphere in float32, and the truth, m; mu: cosines at the base."""
    low, high = shell.radius + shell.base, shell.radius + shell.base + shell.thickness
    at_top = np.arcsin(np.sqrt(1 - mu**2) * low / high)
    given = (shell.radius, shell.base, shell.thickness)
    sphere = Sphere.slant(mu.astype(np.float32), *given).astype(np.float64)
    return Flat.slant(mu, *given), sphere, np.array([chord(shell, float(angle)) for angle in at_top])


def plain_float32() -> Charted:
    """The printed roots and the quotient, both in float32, against the quotient in doubles."""
    up = np.geomspace(3.0, 90.0, 400)
    mu, given = np.sin(np.radians(up)), (RADIUS, BASE, 100.0)
    truth = Sphere.slant(mu, *given)
    errors = [
        np.abs(technique.slant(mu.astype(np.float32), *given).astype(np.float64) / truth - 1)
        for technique in (SphereNaive, Sphere)
    ]
    curves = tuple(Curve(part, up, np.maximum(error, 1e-8)) for part, error in zip(PARTS, errors, strict=True))
    words = "angle of the ray above the horizontal of the base, degrees"
    return Charted(float(errors[0].max()), float(errors[1].max()), curves, words, "relative error of the way", "xy")


def double_scattering() -> Charted:
    """Order 2 on the sunlit side, as printed and corrected, over that of photons."""
    lines = study.order_numbers(PHOTONS, Cache(), lambda share, words: None)
    lines = sorted(lines, key=lambda line: line["depth"] * (1 / line["sun"] + 1))
    paths = np.array([line["depth"] * (1 / line["sun"] + 1) for line in lines])
    ratios = [np.array([line[name] / line["second"][0] for line in lines]) for name in ("thesis", "corrected")]
    judged = next(k for k, line in enumerate(lines) if (line["depth"], line["sun"]) == (2.0, 0.7))
    curves = (
        Curve("truth", paths, np.ones(len(paths)), "photons"),
        *(Curve(part, paths, ratio) for part, ratio in zip(PARTS, ratios, strict=True)),
    )
    wrong, right = (abs(float(ratio[judged]) - 1) for ratio in ratios)
    return Charted(wrong, right, curves, "optical depth along both rays", "order 2 over that of photons", "x")


def low_sun() -> Charted:
    """Light that a thin layer sends back by the height of the sun, against the solver without tables."""
    moments = scattering(Droplets(), BANDS[0], water_index(BANDS[0]))["moments"]
    suns, depth = np.array([0.1, 0.15, 0.2, 0.3, 0.4, 0.55, 0.7, 0.85, 1.0]), np.array([0.5])
    truth = solve(moments, 1.0, depth, suns, np.array([0.5]), np.zeros(1))["R"][0]
    found = [
        model_of(kind, moments).reflectance(depth[:, None], suns)[0, :, 0]
        for kind in ("delta_eddington", "adding_doubling")
    ]
    wrong, right = (abs(float(one[0] / truth[0]) - 1) for one in found)
    curves = (
        Curve("truth", suns, truth),
        *(Curve(part, suns, one) for part, one in zip(PARTS, found, strict=True)),
    )
    return Charted(wrong, right, curves, "cosine of the sun from the zenith", "share of the beam sent back")
