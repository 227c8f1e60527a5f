"""Mie's phase function of water droplets, tabulated."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from renderer.clouds.droplets import Droplets
from renderer.clouds.phase_tables import bake_droplets
from renderer.clouds.technique import PhaseTechnique, padded
from renderer.core.params import bake_arguments, param
from renderer.core.technique import Arrays, Bake


class Mie(Droplets, PhaseTechnique):
    """Forward peak, fogbow and glory as the droplets' size makes them."""

    title: ClassVar[str] = "Mie"
    caption: ClassVar[str] = "The true phase function of water droplets, with forward peak, fogbow and glory."
    paper: ClassVar[str] = "Mie 1908; Belcour 2009, sections 2.3.2 and 3.1"
    textures: ClassVar[Mapping[str, str]] = {"table": "sampler2D"}

    kind: Literal["mie"] = "mie"
    sun_disc: bool = param(
        True, label="Disc of the sun", help="Whether rings are blurred by the sun's own size.", cost="bake"
    )

    def phase_bake(self) -> Bake:
        """Moments and tables of the droplets."""
        arguments = {name: value for name, value in bake_arguments(self).items() if name != "kind"}
        return Bake("phase", bake_droplets, arguments, version=3, seconds=2 + 0.08 * self.radius**2)

    def kept_textures(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """`table` (2, TABLE, 4): the phase function, and below it its convolution with itself, 1/sr."""
        return {"table": padded(np.stack([baked["phase"]["value"], baked["phase"]["twice"]]))}
