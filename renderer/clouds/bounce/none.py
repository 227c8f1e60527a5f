"""No light between ground and clouds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Literal

from renderer.clouds.radiosity.maps import Bounced, BounceMaps
from renderer.clouds.radiosity.technique import BasisTechnique, BounceTechnique, Solved
from renderer.core.technique import Arrays


class NoBounce(BounceTechnique):
    """The first light alone."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = "No light bounces between ground and clouds."
    paper: ClassVar[str] = "as Belcour 2009 left it in ProLand, section 6.1.2"
    textures: ClassVar[Mapping[str, str]] = {}

    kind: Literal["none"] = "none"

    def solve(self, maps: BounceMaps, basis: BasisTechnique | None, baked: Mapping[str, Arrays]) -> Solved:
        """Nothing."""
        return Solved(maps, Bounced(0 * maps.ground, 0 * maps.ground))

    def pictures(self, solved: Solved) -> dict:
        """It has none."""
        return {}
