"""No light between ground and clouds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from renderer.clouds.radiosity.maps import Bounced, BounceMaps
from renderer.clouds.radiosity.technique import BasisTechnique, BounceTechnique, Solved
from renderer.core.technique import Arrays


class NoBounce(BounceTechnique):
    """The first light alone."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = "No light bounces between ground and clouds."
    paper: ClassVar[str] = "as Belcour 2009 left it in ProLand, section 6.1.2"
    textures: ClassVar[Mapping[str, str]] = {}
    extra_declarations: ClassVar[tuple[str, ...]] = ()
    includes: ClassVar[tuple[str, ...]] = ("clouds/bounce_here.glsl",)

    kind: Literal["none"] = "none"

    def solve(self, maps: BounceMaps, basis: BasisTechnique | None, baked: Mapping[str, Arrays]) -> Solved:
        """Nothing."""
        return Solved(maps, Bounced(0 * maps.ground, 0 * maps.ground))

    def pictures(self, solved: Solved) -> dict[str, np.ndarray]:
        """It has none."""
        return {}

    def frame_key(self, state: Any) -> tuple[Any, ...]:
        """Nothing to compute."""
        return ()

    def numbers(self, half: float, centre: tuple[float, float] = (0.0, 0.0)) -> dict[str, Any]:
        """No square."""
        return {}
