"""Orders 1 and 2 in closed form, the rest from a one-dimensional slab, closed by energy: the thesis' model,
corrected."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.closed_model import ClosedModel, FluxTechnique, exit_law, glow, poisson_from, safe
from renderer.clouds.slab import Slab, first_down, first_up, second_down, second_up
from renderer.clouds.slab import direct as passed
from renderer.core.params import param
from renderer.core.technique import Arrays

Order = Literal["all", "transparency", "forward", "single", "double", "rest"]

HEIGHTS = np.array([0.2, 0.4, 0.7, 1.0])
FITS = np.array([[0.602, 1.797, 0.8913], [0.736, 0.702, 0.9051], [0.948, 0.137, 0.9100], [1.196, 0.329, 0.9062]])
"""b, c, beta of the slab's transmittance at these cosines of the sun, for a mean cosine FITTED (formulas a5)."""

FITTED = 0.854


class Orders(FluxTechnique):
    """Transparency, forward peak, orders 1 and 2, and all the rest: each can be shown alone."""

    title: ClassVar[str] = "Orders, corrected"
    caption: ClassVar[str] = "Orders 1 and 2 in closed form, the rest by what energy leaves of a one-dimensional slab."
    paper: ClassVar[str] = "Bouthors, Neyret & Lefebvre 2006; Belcour 2009, section 4.3, corrected"

    kind: Literal["orders"] = "orders"
    order: Order = param(
        "all",
        label="Orders",
        help="Which orders of scattering are shown.",
        source="Belcour 2009, section 4.3",
    )

    def model(self, baked: Mapping[str, Arrays]) -> OrdersModel:
        """The same in float64, all orders together."""
        return OrdersModel(baked["phase"], baked["order_fluxes"])


class OrdersModel(ClosedModel):
    """The twin of `orders.glsl`."""

    def up(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.up`."""
        depth, mu = slab.optical_depth, slab.mu_sun
        known = self.order_flux(0, depth, mu) + self.order_flux(2, depth, mu)
        rest = np.maximum(self.reflectance(depth, mu) - known, 0) * mu[..., None] * exit_law(slab)
        return self.value(slab) * first_up(slab)[..., None] + self.twice(slab) * second_up(slab)[..., None] + rest

    def down(self, slab: Slab) -> np.ndarray:
        """See `SlabModel.down`."""
        depth, mu = slab.optical_depth, slab.mu_sun
        met = self.forward * (depth / mu)[..., None]
        peak = np.exp(-(1 - self.forward) * (depth / mu)[..., None]) * poisson_from(3, met)
        shape = glow(slab, np.asarray(self.phase["spread"]), 3 + met**2 / (met + 4))
        known = passed(depth, mu)[..., None] + self.order_flux(1, depth, mu) + self.order_flux(3, depth, mu) + peak
        rest = np.maximum(self.transmittance(depth, mu) - known, 0) * mu[..., None] * exit_law(slab)
        once, twice = first_down(slab)[..., None], second_down(slab)[..., None]
        return self.value(slab) * once + self.twice(slab) * twice + peak * shape + rest

    def reflectance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.reflectance`."""
        return 1 - self.transmittance(depth, mu)

    def transmittance(self, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """See `SlabModel.transmittance` (formulas a5)."""
        depth, mu = safe(depth, mu)
        # Below the lowest sun of the fits their straight line goes on.
        low = np.clip(np.searchsorted(HEIGHTS, mu) - 1, 0, len(HEIGHTS) - 2)
        share = (mu - HEIGHTS[low]) / (HEIGHTS[low + 1] - HEIGHTS[low])
        b, c, beta = np.moveaxis(FITS[low] + share[..., None] * (FITS[low + 1] - FITS[low]), -1, 0)[..., None]
        scaled = depth[..., None] * (1 - self.asymmetry) / (1 - FITTED)
        through = (b + (1 - b) * np.exp(-np.minimum(c * scaled, 80))) * beta / (scaled - (scaled - 1) * beta)
        return np.clip(through, passed(depth, mu)[..., None], 1)

    def diffuse_reflectance(self, depth: np.ndarray) -> np.ndarray:
        """See `SlabModel.diffuse_reflectance`."""
        return self.even_reflectance(depth)
