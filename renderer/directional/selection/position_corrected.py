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
    steps: int = param(
        2, label="Steps", help="How often a ray is looked at while it crosses a texel of a direction.", unit="count",
        cost="build", ge=1, le=12,
    )
    reach: float = param(
        0.8, label="Reach", help="How far from the ray a point may lie, in texels of the box's longest side.",
        unit="ratio", ge=0.1, le=8, step=0.1,
    )
