"""Functions of a scattering angle as sums of Legendre polynomials: exact moments, values, and blurs.

A function f on the sphere, f(cos) = sum over l of (2 l + 1) / (4 pi) chi_l P_l(cos), has the moments chi_l = integral
over the sphere of f P_l. Convolution on the sphere multiplies moments, so that P * P has chi_l squared (formulas a1).
"""

from __future__ import annotations

import functools

import numpy as np
from numpy.polynomial.legendre import legval
from scipy.special import roots_legendre


def moments_of(values: np.ndarray, nodes: np.ndarray, weights: np.ndarray, count: int) -> np.ndarray:
    """Moments of a function from its values at Gauss-Legendre nodes.

    Args:
        values: (..., K) of the function at `nodes` (cosines), per steradian.
        nodes, weights: (K,) of a quadrature on [-1, 1].
        count: how many moments; exact while K >= (degree of the function + count) / 2.

    Returns:
        (..., count); the first is the integral over the sphere.
    """
    weighted = 2 * np.pi * values * weights
    moments = np.empty((*values.shape[:-1], count))
    before, now = np.zeros_like(nodes), np.ones_like(nodes)
    for degree in range(count):
        moments[..., degree] = weighted @ now
        before, now = now, ((2 * degree + 1) * nodes * now - degree * before) / (degree + 1)
    return moments


def values_of(moments: np.ndarray, cosines: np.ndarray) -> np.ndarray:
    """A function's values from its moments (L,), at cosines of any shape; per steradian."""
    degrees = np.arange(len(moments))
    return legval(cosines, (2 * degrees + 1) / (4 * np.pi) * moments)


def share_within(moments: np.ndarray, angle: float) -> float:
    """Share of a function that lies within `angle` [rad] of the forward direction: closed form of each polynomial."""
    return float(moments @ _cap_integrals(len(moments), np.cos(angle)) / 2)


def disc_moments(count: int, radius: float) -> np.ndarray:
    """Moments (count,) of an even disc of that angular radius [rad], which blurs what it multiplies; the first is 1."""
    if radius == 0:
        return np.ones(count)
    cosine = np.cos(radius)
    return _cap_integrals(count, cosine) / (2 * np.arange(count) + 1) / (1 - cosine)


@functools.cache
def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of the Gauss-Legendre quadrature on [-1, 1]; not to be written to."""
    nodes, weights = roots_legendre(count)
    return nodes, weights


def _cap_integrals(count: int, cosine: float) -> np.ndarray:
    """(2 l + 1) times the integral of P_l from `cosine` to 1, which is P_(l-1) - P_(l+1) at `cosine`."""
    polynomials = np.empty(count + 1)
    polynomials[0], polynomials[1:2] = 1.0, cosine
    for degree in range(1, count):
        twice = (2 * degree + 1) * cosine * polynomials[degree]
        polynomials[degree + 1] = (twice - degree * polynomials[degree - 1]) / (degree + 1)
    below = np.concatenate([[1.0], polynomials[: count - 1]])
    integrals = below - polynomials[1:]
    integrals[0] = 1 - cosine
    return integrals
