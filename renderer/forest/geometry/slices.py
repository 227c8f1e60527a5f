"""Slices parallel to the ground (Meyer & Neyret 1998; Decaudin & Neyret 2004; Cohen 2004, section 2.1)."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.forest.technique import ForestTechnique


class Slices(ForestTechnique):
    """The canopy as textured sheets parallel to the ground."""

    title: ClassVar[str] = "Slices"
    caption: ClassVar[str] = "Textured sheets above the ground; they come apart at grazing view."
    paper: ClassVar[str] = "Meyer & Neyret 1998; Decaudin & Neyret 2004; Cohen 2004, section 2.1"

    kind: Literal["slices"] = "slices"
    count: int = param(32, label="Slices", help="Number of sheets from ground to treetop.", unit="count", ge=2, le=128)
    correct_opacity: bool = param(
        True,
        label="Opacity correction",
        help="Gives each sheet the opacity of the path between it and the next; the thesis does without.",
    )
