"""Light of a plane cloud layer: geometry, closed forms of the first orders, what every technique can say.

The numpy twin of `shaders/clouds/slab.glsl`. Radiances are for each unit of irradiance on a plane that faces the sun.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

GRAZING = 1e-3
"""Least cosine to the layer's normal: below it a path would have no end."""


@dataclass(frozen=True)
class Slab:
    """Places on a layer and directions there, arrays of one shape.

    Attributes:
        optical_depth: of the layer along its normal.
        mu_sun, mu_view: cosines of sun and view to the normal, positive.
        cosine: of the angle between the directions in which light comes and leaves.
        cos_azimuth: of the angle between these directions seen along the normal; 1 = straight on.
    """

    optical_depth: np.ndarray
    mu_sun: np.ndarray
    mu_view: np.ndarray
    cosine: np.ndarray
    cos_azimuth: np.ndarray

    @staticmethod
    def between(depth: np.ndarray, sun: np.ndarray, view: np.ndarray, azimuth: np.ndarray, up: bool) -> Slab:
        """Of light that leaves on the sunlit side (`up`) or the other, by azimuth [rad] with 0 = straight on.

        The scattering angle is that between propagation directions (errata 001-15).
        """
        given = (np.asarray(array, np.float64) for array in (depth, sun, view, azimuth))
        depth, sun, view, azimuth = np.broadcast_arrays(*given)
        across = np.sqrt(1 - sun**2) * np.sqrt(1 - view**2) * np.cos(azimuth)
        return Slab(depth, sun, view, across + (-sun * view if up else sun * view), np.cos(azimuth))


class SlabModel(Protocol):
    """What a scattering technique says of a layer, in three bands: the twin of its GLSL functions."""

    def up(self, slab: Slab) -> np.ndarray:
        """Diffuse radiance (.., 3) that leaves on the sunlit side, 1/sr."""

    def down(self, slab: Slab) -> np.ndarray:
        """Diffuse radiance (.., 3) that leaves on the other side, 1/sr."""

    def reflectance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """Share (.., 3) of a beam that the layer sends back."""

    def transmittance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """Share (.., 3) of a beam that the layer lets through, scattered or not."""

    def diffuse_reflectance(self, depth: np.ndarray) -> np.ndarray:
        """Share (.., 3) of even light from all sides that the layer sends back."""

    def direct(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """Share (..) of a beam that passes unscattered."""


def direct(depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
    """Share of a beam that passes unscattered."""
    return np.exp(-depth / np.maximum(mu, GRAZING))


def first_up(slab: Slab, kept: np.ndarray | float = 1.0) -> np.ndarray:
    """Radiance of order 1 on the sunlit side over P (formulas a4; Blinn 1982), of the depth `kept` times the
    layer's."""
    return -np.expm1(-kept * _slant(slab)) * slab.mu_sun / (slab.mu_sun + slab.mu_view)


def second_up(slab: Slab) -> np.ndarray:
    """Radiance of order 2 on the sunlit side over P * P (formulas a4)."""
    a = _slant(slab)
    return 0.5 * (1 - (1 + a) * np.exp(-a)) * slab.mu_sun / (slab.mu_sun + slab.mu_view)


def first_down(slab: Slab, kept: np.ndarray | float = 1.0) -> np.ndarray:
    """Radiance of order 1 on the other side over P (formulas a4), of the depth `kept` times the layer's."""
    depth = kept * slab.optical_depth
    near = np.minimum(depth / slab.mu_sun, depth / slab.mu_view)
    apart = depth * np.abs(1 / slab.mu_view - 1 / slab.mu_sun)
    return depth / slab.mu_view * np.exp(-near) * mean_decay(apart)


def second_down(slab: Slab) -> np.ndarray:
    """Radiance of order 2 on the other side over P * P: the integral of formulas a4 in closed form.

    With x = depth / mu_sun, y = depth / mu_view, it is y e^(-x) (the integral over s from 0 to 1 of (x (1 - s) + y s)
    e^(-(y - x) s)) / 2, written from the shorter of the two paths so that no exponential grows.
    """
    x, y = slab.optical_depth / slab.mu_sun, slab.optical_depth / slab.mu_view
    short, long = np.minimum(x, y), np.maximum(x, y)
    apart = long - short
    return 0.5 * y * np.exp(-short) * (short * mean_decay(apart) + apart * ramped_decay(apart))


def mean_decay(x: np.ndarray) -> np.ndarray:
    """Mean of e^(-x s) over s from 0 to 1: (1 - e^(-x)) / x."""
    small = np.minimum(x, 1e-2)
    series = 1 - small / 2 * (1 - small / 3 * (1 - small / 4))
    return np.where(x < 1e-2, series, -np.expm1(-np.minimum(x, 600)) / np.maximum(x, 1e-2))


def ramped_decay(x: np.ndarray) -> np.ndarray:
    """Integral of s e^(-x s) over s from 0 to 1: (1 - (1 + x) e^(-x)) / x^2."""
    small = np.minimum(x, 0.1)
    series = 0.5 - small * (1 / 3 - small * (1 / 8 - small * (1 / 30 - small / 144)))
    capped = np.clip(x, 0.1, 600)
    return np.where(x < 0.1, series, (1 - (1 + capped) * np.exp(-capped)) / np.maximum(x, 0.1) ** 2)


def _slant(slab: Slab) -> np.ndarray:
    """Optical depth of the way in and the way out together."""
    return slab.optical_depth * (1 / slab.mu_sun + 1 / slab.mu_view)
