"""The shadow hemisphere bit by bit."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.directional.self_shadowing import SelfShadowTechnique


class Bits(SelfShadowTechnique):
    """A bit for each direction of a point's hemisphere, 17 bytes for 129: nothing is lost but what lies between."""

    title: ClassVar[str] = "Bits"
    caption: ClassVar[str] = "Each direction of a point's hemisphere is lit or dark: a bit each, looked up."
    paper: ClassVar[str] = "Porquet 2005, section on self-shadowing by hemispheres; edges after Green 2007"
    most_directions: ClassVar[int] = 2049

    kind: Literal["bits"] = "bits"
    blend: bool = param(
        True,
        label="Blend directions",
        help="Mix the four directions around the light's, rather than take the nearest.",
        cost="build",
    )
    sharpness: float = param(
        2.0,
        label="Sharpness",
        help="How much narrower than the step between directions the edge of a blended shadow is; 1 leaves the blend.",
        unit="ratio",
        ge=1,
        le=64,
        source="Green 2007",
    )
