"""What the techniques of closed forms share: lookups of the phase function and of fluxes, exit laws, the forward
glow."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from renderer.clouds.order_fluxes import bake_order_fluxes, met_share
from renderer.clouds.phase_tables import look_up
from renderer.clouds.slab import GRAZING, Slab, direct
from renderer.clouds.slab_axes import cosine_place, depth_place
from renderer.clouds.slab_axes import look_up as look_up_axes
from renderer.clouds.technique import ScatteringTechnique, padded
from renderer.core.technique import Arrays, Bake


class FluxTechnique(ScatteringTechnique):
    """A technique of closed forms that knows the fluxes of the first orders."""

    textures: ClassVar[Mapping[str, str]] = {"fluxes": "sampler2D"}

    def bakes(self, state: Any) -> list[Bake]:
        """Fluxes of the first orders."""
        return [Bake("order_fluxes", bake_order_fluxes, {}, (state.phase.phase_bake(),), seconds=1)]

    def kept_textures(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Fluxes of the four kinds one above the other, by optical depth and sun."""
        return {"fluxes": padded(np.concatenate(list(baked["order_fluxes"]["fluxes"])))}


class ClosedModel:
    """Base of their twins.

    Args:
        phase: the bake `phase`. fluxes: the bake `order_fluxes`, where the technique has it.
    """

    direct = staticmethod(direct)

    def __init__(self, phase: Arrays, fluxes: Arrays | None = None) -> None:
        self.phase = phase
        self.asymmetry = np.asarray(phase["asymmetry"], np.float64)
        self.forward = np.asarray(phase["forward"], np.float64)
        self._fluxes = fluxes

    def value(self, slab: Slab) -> np.ndarray:
        """The phase function (.., 3) of a slab's scattering angles, 1/sr."""
        return look_up(self.phase["value"], slab.cosine)

    def twice(self, slab: Slab) -> np.ndarray:
        """The phase function convolved with itself, 1/sr."""
        return look_up(self.phase["twice"], slab.cosine)

    def order_flux(self, number: int, depth: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """Flux (.., 3) of one of `order_fluxes.KINDS`, over the beam's."""
        assert self._fluxes is not None
        table = look_up_axes(self._fluxes["fluxes"][number], depth_place(depth), cosine_place(mu))
        return table * met_share(depth, mu)[..., None] ** (1 + number // 2)

    def even_first(self, depth: np.ndarray) -> np.ndarray:
        """Share (.., 3) of even light that order 1 sends back."""
        assert self._fluxes is not None
        return look_up_axes(self._fluxes["even"], depth_place(depth)) * -np.expm1(-2 * depth)[..., None]

    def even_reflectance(self, depth: np.ndarray) -> np.ndarray:
        """Share of even light that a two-stream layer sends back: formulas a5."""
        thick = 0.75 * (1 - self.asymmetry) * np.asarray(depth, np.float64)[..., None]
        return thick / (1 + thick)


def exit_law(slab: Slab) -> np.ndarray:
    """Radiance of light that has forgotten where it came from, over its flux: Eddington's law (formulas a5)."""
    return ((2 + 3 * slab.mu_view) / (4 * np.pi))[..., None]


def safe(depth: np.ndarray, mu: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Depth and cosine as arrays of one shape, the cosine no less than grazing."""
    depth, mu = np.broadcast_arrays(np.asarray(depth, np.float64), np.asarray(mu, np.float64))
    return depth, np.maximum(mu, GRAZING)


def poisson_from(count: int, met: np.ndarray) -> np.ndarray:
    """e^-m (e^m - 1 - m - ... ): the chance of `count` events or more (1 or 3), where m are expected."""
    if count == 1:
        return -np.expm1(-met)
    few = np.minimum(met, 0.3)
    series = few**3 / 6 * (1 - few * (3 / 4 - few * (3 / 10 - few / 12)))
    return np.where(met < 0.3, series, 1 - np.exp(-met) * (1 + met + met**2 / 2))


def glow(slab: Slab, spread: np.ndarray, times: np.ndarray) -> np.ndarray:
    """A Gaussian around the sun, 1/sr: `times` deflections whose mean square is `spread` [rad^2] each (formulas a3)."""
    width = spread * times
    # 2 (1 - cos) is the angle's square near the sun, and falls off for good behind it.
    return np.exp(-2 * (1 - slab.cosine[..., None]) / width) / (np.pi * width)
