"""Apparent thickness on the sphere, as printed and in plain float32."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.technique import CloudsTechnique


class SphereNaive(CloudsTechnique):
    """The shell by the quadratic as printed: differences of squares of the planet's radius leave noise in float32."""

    title: ClassVar[str] = "Sphere, plain float32"
    caption: ClassVar[str] = (
        "The shell by the printed roots: squares of the planet's radius cancel, and leave rings in thin layers."
    )
    paper: ClassVar[str] = "Belcour 2009, section 4.2.1"

    kind: Literal["sphere_naive"] = "sphere_naive"

    @staticmethod
    def slant(mu: np.ndarray, radius: float, base: float, thickness: float) -> np.ndarray:
        """Metres through a layer of rays with such cosines at its base, in the precision of these (errata 001-2)."""
        low, high = mu.dtype.type(radius + base), mu.dtype.type(radius + base) + mu.dtype.type(thickness)
        square = high * high - low * low * (1 - mu * mu)
        return np.maximum(np.sqrt(np.maximum(square, 0)) - low * mu, mu.dtype.type(1e-3))
