"""No shadow: every point sees the sun."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.forest.technique import ForestTechnique


class NoShadow(ForestTechnique):
    """The picture without shadows, against which each kind of shadow is seen."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = "Every leaf sees the sun. The zero against which shadows are judged."
    paper: ClassVar[str] = "-"

    kind: Literal["none"] = "none"
