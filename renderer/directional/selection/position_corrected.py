"""The point that lies nearest the pixel's ray."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.directional.technique import DirectionalTechnique


class PositionCorrected(DirectionalTechnique):
    """Each pixel searches what the directions round its ray see for the point that lies on the ray."""

    title: ClassVar[str] = "Position-corrected"
    caption: ClassVar[str] = "Each pixel takes, of the points of the directions round it, the one nearest its ray."
    paper: ClassVar[str] = "after Porquet 2005; depth correction as in Gortler, Grzeszczuk, Szeliski & Cohen 1996"
    count: ClassVar[int] = 1
    per_pixel: ClassVar[bool] = True

    kind: Literal["position_corrected"] = "position_corrected"
    reach: float = param(
        0.4, label="Reach",
        help="How far a ray may pass behind a texel that no direction sees past, in texels of the longest side.",
        unit="ratio", ge=0.1, le=8, step=0.1,
    )
