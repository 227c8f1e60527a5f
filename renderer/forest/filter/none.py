"""No filtering: the finest voxels at every distance, as the thesis shows its pictures."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.forest.technique import ForestTechnique


class NoFilter(ForestTechnique):
    """Always the finest level."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = "Finest voxels at every distance: sharp, and shimmering far away."
    paper: ClassVar[str] = "Cohen 2004, section 6.6"

    kind: Literal["none"] = "none"
