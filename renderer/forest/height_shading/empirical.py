"""Empirical height shading (Cohen 2004, section 3.2)."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.forest.technique import ForestTechnique


class Empirical(ForestTechnique):
    """Darkens the foot of the trees and lights their tops, whatever the sun: C(h) = 0.5 + h."""

    title: ClassVar[str] = "Empirical"
    caption: ClassVar[str] = "Foot of the trees at half light, tops at one and a half; the same for every sun."
    paper: ClassVar[str] = "Cohen 2004, section 3.2 (after Reeves & Blau 1985)"

    kind: Literal["empirical"] = "empirical"
    strength: float = param(
        1.0,
        label="Strength",
        help="Share of the effect; 0 leaves light alone.",
        unit="ratio",
        ge=0,
        le=1,
        source="Cohen 2004, section 5.4",
    )
    foot: float = param(
        0.5,
        label="Factor at the ground",
        help="Light factor at the foot of the trees.",
        unit="ratio",
        ge=0,
        le=2,
        source="Cohen 2004, section 3.2",
    )
    rise: float = param(
        1.0,
        label="Rise to the top",
        help="What the factor gains from foot to top.",
        unit="ratio",
        ge=0,
        le=2,
        source="Cohen 2004, section 3.2",
    )
