"""The constant sky of the thesis."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import Colour, param
from renderer.forest.technique import ForestTechnique


class ConstantSky(ForestTechnique):
    """A fixed share of a tinted light, everywhere and at every hour."""

    title: ClassVar[str] = "Constant"
    caption: ClassVar[str] = "The thesis' tinted constant: 30 % of the light, the same under every leaf."
    paper: ClassVar[str] = "Cohen 2004, listings 10.1 and 10.3"

    kind: Literal["constant"] = "constant"
    tint: Colour = param(
        (0.3, 0.5, 0.6), label="Tint", help="Colour of the sky's light.", source="Cohen 2004, listing 10.3"
    )
    share: float = param(
        0.3,
        label="Share",
        help="Weight of the sky against the sun's irradiance.",
        unit="ratio",
        ge=0,
        le=1,
        source="Cohen 2004, listing 10.1",
    )
