"""Rayleigh's phase function: particles much smaller than the wavelength."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.clouds.phase_tables import bake_moments
from renderer.clouds.technique import PhaseTechnique
from renderer.core.technique import Bake


class Rayleigh(PhaseTechnique):
    """As much forward as backward: wrong for a cloud, and shown for that."""

    title: ClassVar[str] = "Rayleigh"
    caption: ClassVar[str] = "Air molecules instead of droplets: no forward peak, no fogbow, no glory."
    paper: ClassVar[str] = "Strutt (Lord Rayleigh) 1871; Belcour 2009, section 2.3.1"

    kind: Literal["rayleigh"] = "rayleigh"

    def phase_bake(self) -> Bake:
        """Three moments are all it has."""
        return Bake("phase", bake_moments, {"moments": [1.0, 0.0, 0.1]}, version=3, seconds=0.2)
