"""Orders of scattering as the thesis prints them: order 2 with order 1's factor, about twice too bright."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.closed_model import ClosedModel, glow, poisson_from, safe
from renderer.clouds.slab import Slab, first_down, first_up
from renderer.clouds.technique import ScatteringTechnique
from renderer.core.params import param
from renderer.core.technique import Arrays

Order = Literal["all", "transparency", "forward", "single", "double", "rest"]


class ThesisOrders(ScatteringTechnique):
    """The printed formulas side by side, without a common account of energy."""

    title: ClassVar[str] = "Orders, as printed"
    caption: ClassVar[str] = "The thesis' own formulas: order 2 about twice too bright, the rest in one dimension."
    paper: ClassVar[str] = "Belcour 2009, sections 3.2 and 4.3"

    kind: Literal["thesis_orders"] = "thesis_orders"
    order: Order = param(
        "all",
        label="Orders",
        help="Which orders of scattering are shown.",
        source="Belcour 2009, section 4.3",
    )

    def model(self, baked: Mapping[str, Arrays]) -> ThesisModel:
        """The same in float64, all orders together."""
        return ThesisModel(baked["phase"])


class ThesisModel(ClosedModel):
    """The twin of `thesis_orders.glsl`."""

    def up(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.up`."""
        once = first_up(slab)[..., None]
        rest = self._rest(slab, up=True) * (slab.mu_sun / np.pi)[..., None]
        return (self.value(slab) + self.twice(slab)) * once + rest

    def down(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.down`."""
        once = first_down(slab)[..., None]
        path = (slab.optical_depth / slab.mu_sun)[..., None]
        peak = np.exp(-(1 - self.forward) * path) * poisson_from(1, self.forward * path)
        rest = self._rest(slab, up=False) * (slab.mu_sun / np.pi)[..., None]
        around = peak * glow(slab, np.asarray(self.phase["spread"]), np.ones(3))
        return (self.value(slab) + self.twice(slab)) * once + around + rest

    def _rest(self, slab: Slab, up: bool) -> np.ndarray:
        """Orders 3 and more of the one-dimensional slab along the sun's ray."""
        path = (slab.optical_depth / slab.mu_sun)[..., None]
        ahead = (1 + self.asymmetry) / 2
        if up:
            gone = (1 - ahead) * (-np.expm1(-2 * path) + ahead * (1 - (1 + 2 * path) * np.exp(-2 * path))) / 2
            return np.maximum(self.reflectance(slab.optical_depth, slab.mu_sun) - gone, 0)
        gone = np.exp(-path) * (1 + ahead * path + (ahead * path) ** 2 / 2)
        return np.maximum(self.transmittance(slab.optical_depth, slab.mu_sun) - gone, 0)

    def reflectance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.reflectance`."""
        return 1 - self.transmittance(depth, mu)

    def transmittance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.transmittance`: the slab of formulas a5, without its transient."""
        depth, mu = safe(depth, mu)
        path = (depth / mu)[..., None]
        ahead = (1 + self.asymmetry) / 2
        return ahead / (path - (path - 1) * ahead)

    def diffuse_reflectance(self, depth: np.ndarray) -> np.ndarray:
        """See `SlabModel.diffuse_reflectance`: along twice the depth, the mean path of even light."""
        return self.reflectance(depth, np.array(0.5))
