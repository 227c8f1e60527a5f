"""Apparent thickness on the sphere."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.technique import CloudsTechnique


class Sphere(CloudsTechnique):
    """The layer as a shell: right from the ground to space, and at the limb."""

    title: ClassVar[str] = "Sphere"
    caption: ClassVar[str] = (
        "The layer is a shell round the planet: a ray's path through it is that of the sphere, from any camera."
    )
    paper: ClassVar[str] = "Belcour 2009, section 4.2"

    kind: Literal["sphere"] = "sphere"

    @staticmethod
    def slant(mu: np.ndarray, radius: float, base: float, thickness: float) -> np.ndarray:
        """Metres through a layer of rays with such cosines at its base, in the precision of these (formulas a8)."""
        low, high = mu.dtype.type(radius + base), mu.dtype.type(thickness)
        square = high * (2 * low + high)
        return np.asarray(square / (np.sqrt(square + low * low * mu * mu) + low * mu))
