"""Apparent thickness of a flat slab."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.technique import CloudsTechnique


class Flat(CloudsTechnique):
    """The layer as a flat slab where a ray meets it: thickness over cosine."""

    title: ClassVar[str] = "Flat"
    caption: ClassVar[str] = (
        "Thickness over cosine: right to a few per cent but at the limb, where the path grows without end."
    )
    paper: ClassVar[str] = "Bouthors, Neyret and Lefebvre 2006; Belcour 2009, section 4.2.4"

    kind: Literal["flat"] = "flat"

    @staticmethod
    def slant(mu: np.ndarray, radius: float, base: float, thickness: float) -> np.ndarray:
        """Metres through a layer of rays with such cosines at its base, in the precision of these."""
        return thickness / mu
