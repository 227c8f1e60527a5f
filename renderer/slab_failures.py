"""Where techniques of a plane layer fail: the numbers and charts of their cases."""

from __future__ import annotations

import numpy as np

from renderer.clouds.geometry.flat import Flat
from renderer.clouds.geometry.sphere import Sphere
from renderer.core.failure import Charted, Curve
from renderer.reference.cloud_shell import Shell
from renderer.reference.cloud_shell_single import chord

RADIUS, BASE = 6.35e6, 2500.0
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
