"""Two streams: reflectance and transmittance in closed form, order 1 exact, the rest by Eddington's exit law."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.closed_model import ClosedModel, FluxTechnique, exit_law, safe
from renderer.clouds.slab import Slab, first_down, first_up
from renderer.clouds.slab import direct as passed
from renderer.core.technique import Arrays


class DeltaEddington(FluxTechnique):
    """Nothing is fitted, all that is scattered twice and more leaves alike in every azimuth."""

    title: ClassVar[str] = "Delta-Eddington"
    caption: ClassVar[str] = "Two streams in closed form, order 1 by the true phase function, no glow round the sun."
    paper: ClassVar[str] = "Shettle & Weinman 1970; Joseph, Wiscombe & Weinman 1976"

    kind: Literal["delta_eddington"] = "delta_eddington"

    def model(self, baked: Mapping[str, Arrays]) -> EddingtonModel:
        """The same in float64."""
        return EddingtonModel(baked["phase"], baked["order_fluxes"])


class EddingtonModel(ClosedModel):
    """The twin of `delta_eddington.glsl`."""

    def up(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.up`."""
        depth, mu = slab.optical_depth, slab.mu_sun
        rest = np.maximum(self.reflectance(depth, mu) - self.order_flux(0, depth, mu), 0)
        return self.value(slab) * first_up(slab)[..., None] + rest * mu[..., None] * exit_law(slab)

    def down(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.down`."""
        depth, mu = slab.optical_depth, slab.mu_sun
        gone = passed(depth, mu)[..., None] + self.order_flux(1, depth, mu)
        rest = np.maximum(self.transmittance(depth, mu) - gone, 0)
        return self.value(slab) * first_down(slab)[..., None] + rest * mu[..., None] * exit_law(slab)

    def reflectance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.reflectance`."""
        return 1 - self.transmittance(depth, mu)

    def transmittance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.transmittance` (formulas a5)."""
        depth, mu = (array[..., None] for array in safe(depth, mu))
        g = self.asymmetry
        through = np.exp(-np.minimum((1 - g**2) * depth / mu, 80))
        return ((2 / 3 + mu) + (2 / 3 - mu) * through) / (4 / 3 + (1 - g) * depth)

    def diffuse_reflectance(self, depth: np.ndarray) -> np.ndarray:
        """See `SlabModel.diffuse_reflectance`."""
        return self.even_reflectance(depth)
