"""No self-shadow."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.directional.technique import DirectionalTechnique


class NoShadow(DirectionalTechnique):
    """Every point sees all light above its own horizon."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = "Each point sees every light above its own horizon."
    paper: ClassVar[str] = "none"

    kind: Literal["none"] = "none"
