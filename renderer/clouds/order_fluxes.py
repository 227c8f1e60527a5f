"""Hemispherical fluxes of orders 1 and 2, for techniques that give the rest what energy leaves.

Radiances are those of formulas a4; the azimuth's mean of the phase function and a Gauss quadrature over the cosine
make fluxes of them. They are stored over the share of the beam that meets a droplet, once for each order.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.clouds.legendre import gauss
from renderer.clouds.slab import GRAZING, Slab, first_down, first_up, second_down, second_up
from renderer.clouds.slab_axes import cosine_place, cosines, depth_place, depths, look_up
from renderer.core.technique import Arrays

Progress = Callable[[float, str], None]

KINDS = ("first_up", "first_down", "second_up", "second_down")
"""Fluxes in the order in which they are stacked."""


def bake_order_fluxes(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> Arrays:
    """Bake the fluxes of orders 1 and 2.

    Returns:
        `fluxes` (4, T, K, 3): of KINDS, over the met share (order 1) or its square (order 2), by optical depth and
        cosine of the sun; `even` (T, 3): share of even light that order 1 sends back, over 1 - e^(-2 tau).
    """
    moments = inputs["phase"]["moments"]
    mu, tau = cosines(), depths()
    x, w = gauss(max(moments.shape[1] // 2 + 32, 64))
    view, weight = (x + 1) / 2, w / 2
    slab = Slab(tau[:, None, None], mu[:, None], view, np.zeros(()), np.zeros(()))
    factors = [first_up(slab), first_down(slab), second_up(slab), second_down(slab)]
    met = met_share(tau[:, None], mu)
    fluxes = np.empty((4, len(tau), len(mu), 3))
    for band, chi in enumerate(moments):
        progress(band / len(moments), "fluxes of the first orders")
        for number, factor in enumerate(factors):
            order = 1 + number // 2
            kernel = _mean_over_azimuth(chi**order, view, mu, backward=number % 2 == 0)
            flux = np.einsum("tsv,sv,v->ts", factor, kernel, weight * view) / mu
            fluxes[number, :, :, band] = flux / met**order
    # What order 1 sends back of even light: the same by a quadrature over the sun's cosine.
    nodes, weights = gauss(24)
    sun = (nodes + 1) / 2
    back = look_up(fluxes[0], depth_place(tau[:, None]), cosine_place(sun)) * met_share(tau[:, None], sun)[..., None]
    even = np.einsum("tsb,s->tb", back, weights * sun) / -np.expm1(-2 * tau)[:, None]
    return {"fluxes": fluxes.astype(np.float32), "even": even.astype(np.float32)}


def met_share(depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Share of a beam that meets a droplet."""
    return -np.expm1(-depth / np.maximum(mu, GRAZING))


def _mean_over_azimuth(moments: np.ndarray, view: np.ndarray, sun: np.ndarray, backward: bool) -> np.ndarray:
    """Integral over azimuth (s, v) of a function of the scattering angle: its addition theorem's order 0."""
    total = np.zeros((len(sun), len(view)))
    before = [np.zeros_like(sun), np.zeros_like(view)]
    now = [np.ones_like(sun), np.ones_like(view)]
    for degree, chi in enumerate(moments):
        sign = -1.0 if backward and degree % 2 else 1.0
        total += sign * chi * (2 * degree + 1) / 2 * now[0][:, None] * now[1]
        for place, mu in enumerate((sun, view)):
            following = ((2 * degree + 1) * mu * now[place] - degree * before[place]) / (degree + 1)
            before[place], now[place] = now[place], following
    return total
