"""Order 1 alone."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from renderer.clouds.closed_model import ClosedModel, FluxTechnique, safe
from renderer.clouds.slab import Slab, first_down, first_up
from renderer.clouds.slab import direct as passed
from renderer.clouds.technique import padded
from renderer.core.technique import Arrays


class Single(FluxTechnique):
    """Light that met one droplet: fogbow and glory stand in it unblurred, and a cloud is far too dark."""

    title: ClassVar[str] = "Single scattering"
    caption: ClassVar[str] = "Light that met one droplet alone: sharp fogbow and glory, a dark cloud."
    paper: ClassVar[str] = "Blinn 1982; Belcour 2009, section 3.2.1"
    textures: ClassVar[Mapping[str, str]] = {"fluxes": "sampler2D", "even": "sampler2D"}
    conserves: ClassVar[bool] = False

    kind: Literal["single"] = "single"

    def kept_textures(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Fluxes by optical depth and sun, those of even light by depth."""
        return {**super().kept_textures(state, baked), "even": padded(baked["order_fluxes"]["even"][None])}

    def model(self, baked: Mapping[str, Arrays]) -> SingleModel:
        """The same in float64."""
        return SingleModel(baked["phase"], baked["order_fluxes"])


class SingleModel(ClosedModel):
    """The twin of `single.glsl`."""

    def up(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.up`."""
        return self.value(slab) * first_up(slab)[..., None]

    def down(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.down`."""
        return self.value(slab) * first_down(slab)[..., None]

    def reflectance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.reflectance`."""
        return self.order_flux(0, *safe(depth, mu))

    def transmittance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.transmittance`."""
        depth, mu = safe(depth, mu)
        return self.order_flux(1, depth, mu) + passed(depth, mu)[..., None]

    def diffuse_reflectance(self, depth: np.ndarray) -> np.ndarray:
        """See `SlabModel.diffuse_reflectance`."""
        return self.even_first(np.asarray(depth, np.float64))
