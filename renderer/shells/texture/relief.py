"""A raised figure of semi-transparent matter, after figures 4.7 and 6.2 of Dufort 2005."""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.dragon import dragon
from renderer.shells.texture.raised import under
from renderer.shells.texture.source import Procedure


class Relief(Procedure):
    """A dragon in relief."""

    kind: Literal["relief"] = "relief"
    figures: int = param(
        1, label="Figures", help="Along each side of the repeated square.", unit="count", cost="bake", ge=1, le=8
    )
    ground: float = param(
        0.12, label="Ground", help="Height of the matter between the figures.", unit="ratio", cost="bake", ge=0, le=0.5,
        step=0.01,
    )
    optical_depth: float = param(
        5.0, label="Optical depth", help="Along the shell's whole thickness.", cost="bake", ge=0, le=60
    )
    thick: Colour = param((0.12, 0.5, 0.3), label="Figure", help="Reflectance of the raised matter.", cost="bake")
    thin: Colour = param((0.75, 0.8, 0.55), label="Ground's colour", help="Reflectance of the ground.", cost="bake")
    second_opacity: float = param(
        1.0, label="Opacity of the ground", help="Factor on the opacity below the figures.", unit="ratio", cost="host",
        ge=0, le=1, source="Dufort 2005, figure 5.13",
    )

    def matter(self) -> Matter:
        """The figure is the first material, the ground the second; both have the surface's normal."""
        place = (np.arange(self.across) + 0.5) / self.across * self.figures % 1.0
        figure = dragon(place[None, :], place[:, None])
        # Smooth over about a voxel, and round at the top.
        height = self.ground + (0.95 - self.ground) * figure
        share = np.clip(figure / 0.12, 0.0, 1.0)[..., None]
        tint = np.asarray(self.thin) * (1.0 - share) + np.asarray(self.thick) * share * (0.75 + 0.5 * figure[..., None])
        opacity = -np.expm1(-self.optical_depth / self.layers)
        found = under(self, height, tint, opacity)
        flat = np.broadcast_to(share[..., 0] < 0.5, self.shape)
        found.material[flat & (found.material > 0)] = 2
        return found
