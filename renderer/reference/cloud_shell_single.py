"""Order 1 of a layer round a sphere, by quadrature along the ray of the eye, and the plane's closed form beside it.

Belcour 2009, section 4.3.2, with the corrected distance to the sun (errata 001-17): eye and sun stand in one plane,
on either side of the normal where the ray comes in. The phase function is left out, as it is the same for both.
"""

from __future__ import annotations

import itertools

import numpy as np

from renderer.reference.cloud_shell import Shell

NODES = 4000
"""Nodes of the quadrature over the ray."""


def chord(shell: Shell, angle: float) -> float:
    """Metres of the first crossing of the layer by a ray that comes in at an angle [rad] to the normal at its top."""
    outer = shell.radius + shell.base + shell.thickness
    depth = shell.thickness * (2 * outer - shell.thickness)  # outer^2 - inner^2, without cancellation
    along = outer * np.cos(angle)
    if along**2 <= depth:
        return float(2 * along)
    return float(depth / (along + np.sqrt(along**2 - depth)))


def sphere_single(shell: Shell, view: float, sun: float) -> float:
    """Radiance of order 1 on the sunlit side over P and the beam's irradiance.

    Args:
        view, sun: angles to the normal at the top of the layer, rad.
    """
    outer = shell.radius + shell.base + shell.thickness
    nodes, weights = np.polynomial.legendre.leggauss(200)
    edges = np.linspace(0, min(chord(shell, view), 40 / shell.extinction), NODES // len(nodes) + 1)
    total = 0.0
    for low, high in itertools.pairwise(edges):
        way = low + (high - low) * (nodes + 1) / 2
        b = outer * np.cos(sun) - way * np.cos(view + sun)
        c = way**2 - 2 * outer * way * np.cos(view)
        to_sun = -c / (b + np.sqrt(b**2 - c))
        total += float(weights @ np.exp(-shell.extinction * (way + to_sun))) * (high - low) / 2 * shell.extinction
    return total


def plane_single(shell: Shell, view: float, sun: float) -> float:
    """The same of a plane layer as thick: Blinn's closed form (formulas a4)."""
    mu_view, mu_sun = np.cos(view), np.cos(sun)
    depth = shell.extinction * shell.thickness
    return float(mu_sun / (mu_sun + mu_view) * -np.expm1(-depth * (1 / mu_sun + 1 / mu_view)))
