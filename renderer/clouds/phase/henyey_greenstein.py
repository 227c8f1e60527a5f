"""Henyey and Greenstein's phase function: one lobe of a given mean cosine."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.phase_tables import bake_moments
from renderer.clouds.technique import PhaseTechnique
from renderer.core.params import param
from renderer.core.technique import Bake

MOMENTS = 600
"""Moments kept: at the largest mean cosine the last is below 1e-7."""


class HenyeyGreenstein(PhaseTechnique):
    """A smooth lobe: right in the mean, without fogbow or glory."""

    title: ClassVar[str] = "Henyey-Greenstein"
    caption: ClassVar[str] = "One smooth forward lobe: the light is right in the mean, fogbow and glory are lost."
    paper: ClassVar[str] = "Henyey & Greenstein 1941"

    kind: Literal["henyey_greenstein"] = "henyey_greenstein"
    asymmetry: float = param(
        0.86,
        label="Mean cosine",
        help="Mean cosine of the scattering angle: 0 scatters evenly, towards 1 ever more forward.",
        unit="ratio",
        cost="bake",
        ge=0,
        le=0.97,
        step=0.01,
        source="that of droplets of 10 um",
    )

    def phase_bake(self) -> Bake:
        """Its moments are the powers of the mean cosine."""
        with np.errstate(under="ignore"):
            moments = self.asymmetry ** np.arange(MOMENTS, dtype=np.float64)
        return Bake(
            "phase",
            bake_moments,
            {"moments": moments[(moments > 1e-12) | (np.arange(MOMENTS) < 2)].tolist()},
            version=3,
            seconds=0.5,
        )
