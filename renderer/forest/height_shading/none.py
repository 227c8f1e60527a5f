"""No height shading."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.forest.technique import ForestTechnique


class NoHeightShading(ForestTechnique):
    """Light does not depend on the height in the canopy."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = "Light as the other techniques give it, whatever the height in the canopy."
    paper: ClassVar[str] = "-"

    kind: Literal["none"] = "none"
