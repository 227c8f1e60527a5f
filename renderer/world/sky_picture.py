"""The sky's small picture, and what sums over it: irradiance, and moments of its radiance.

Rows are elevations, columns azimuths from the sun, both denser towards 0; radiance is bilinear between them.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np

from renderer.world import atmosphere
from renderer.world.atmosphere import Floats

VIEW_SHAPE = (64, 32)
"""Elevations and azimuths of the sky's picture."""

MOMENTS: dict[str, tuple[int, int, Callable[[Floats], Floats | float]]] = {
    "sky_even": (0, 0, lambda azimuth: 1.0),
    "sky_upward": (1, 0, lambda azimuth: 1.0),
    "sky_sunward": (0, 1, np.cos),
    "sky_upward2": (2, 0, lambda azimuth: 1.0),
    "sky_sunward2": (0, 2, lambda azimuth: np.cos(azimuth) ** 2),
    "sky_across2": (0, 2, lambda azimuth: np.sin(azimuth) ** 2),
    "sky_upward_sunward": (1, 1, np.cos),
}
"""Moments of the sky's radiance: powers of a direction's height, of its level part, and what of that lies sunward."""


@functools.cache
def view_directions() -> tuple[Floats, Floats]:
    """Elevations (rows,) and azimuths from the sun (columns,) of the sky's picture, in radians."""
    rows, columns = VIEW_SHAPE
    return 0.5 * np.pi * np.linspace(0.0, 1.0, rows) ** 2, np.pi * np.linspace(0.0, 1.0, columns) ** 2


@functools.cache
def irradiance_weights() -> Floats:
    """Weights that make a sum over the sky's picture the irradiance of a horizontal plane, (rows, columns) in sr.

    They integrate the very function that bilinear interpolation of the picture draws: a sky of radiance one gives pi.
    """
    return _weights(1, 0, lambda azimuth: 1.0)


def _weights(sines: int, cosines: int, around: Callable[[Floats], Floats | float]) -> Floats:
    """Weights of a sum over the sky's picture, (rows, columns) in sr.

    Args:
        sines, cosines: powers, of the elevation's sine and cosine, that radiance is weighed by. around: the same of the
            azimuth from the sun.
    """
    x, w = atmosphere.legendre(12)

    def of_hats(cells: int, measure: Callable[[Floats], Floats]) -> Floats:
        weights = np.zeros(cells + 1)
        for cell in range(cells):
            share = w * measure((cell + x) / cells) / cells
            weights[cell] += np.sum(share * (1.0 - x))
            weights[cell + 1] += np.sum(share * x)
        return weights

    def over(u: Floats) -> Floats:  # de/du = pi u, where e = (pi/2) u^2
        e = 0.5 * np.pi * u * u
        return np.sin(e) ** sines * np.cos(e) ** (1 + cosines) * np.pi * u

    def round_about(u: Floats) -> Floats:  # both halves of the sky; a = pi u^2
        return around(np.pi * u * u) * 4.0 * np.pi * u

    rows, columns = VIEW_SHAPE
    return of_hats(rows - 1, over)[:, None] * of_hats(columns - 1, round_about)[None, :]


@functools.cache
def moment_weights() -> Floats:
    """Weights that make sums over the sky's picture its moments, (moments of `MOMENTS`, rows * columns) in sr."""
    return np.stack([_weights(*parts).ravel() for parts in MOMENTS.values()])
