"""Deformed rings of wood: figure 5.11 of Dufort 2005.

After Perlin 1985, section "wood": rings by the distance from an axis that noise has bent.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.noise import noise
from renderer.shells.texture.raised import under
from renderer.shells.texture.source import Procedure, generator


class Wood(Procedure):
    """Wood, its fibres along v."""

    kind: Literal["wood"] = "wood"
    seed: int = param(8, label="Seed", help="Of the rings' deformation.", cost="bake", ge=0, le=2**31 - 1)
    rings: float = param(
        5.0, label="Rings", help="In a thickness of the shell.", unit="count", cost="bake", ge=0.5, le=20, step=0.5
    )
    deformation: float = param(
        0.5, label="Deformation", help="How far the rings stray, against the thickness.", unit="ratio", cost="bake",
        ge=0, le=2, step=0.05,
    )
    light: Colour = param((0.62, 0.38, 0.17), label="Early wood", help="Reflectance of the wide bands.", cost="bake")
    dark: Colour = param((0.26, 0.11, 0.04), label="Late wood", help="Reflectance of the narrow bands.", cost="bake")

    def matter(self) -> Matter:
        """Opaque down to the base surface, worn where it is soft."""
        rng = generator(self.seed)
        x, y, z = self.centres()
        cells = max(2, round(0.75 * self.side))
        stray = noise(rng, x, y, z, self.side, cells, 2, (0.5, 1.0))
        arch = 0.55 * np.cos(2 * np.pi * x / self.side)
        phase = self.rings * (z + arch + self.deformation * stray)
        fibre = noise(rng, x, y, z, self.side, max(4, self.across // 6), 1, (0.12, 1.0))
        # Late wood darkens slowly and ends soon.
        part = phase - np.floor(phase)
        late = (part**3 * np.clip((1.0 - part) / 0.12, 0.0, 1.0))[..., None]
        tint = (np.asarray(self.light, np.float32) * (1 - late) + np.asarray(self.dark, np.float32) * late)
        tint = tint * (1.0 + 0.25 * fibre)[..., None]
        top = late[min(int(0.8 * self.layers), self.layers - 1), ..., 0]
        return under(self, 0.86 + 0.09 * top, tint)
