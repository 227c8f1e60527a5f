"""No shadow."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.shells.technique import ShadowTechnique


class NoShadow(ShadowTechnique):
    """All of the sun reaches every place."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = "All of the sun reaches every place."
    paper: ClassVar[str] = ""

    kind: Literal["none"] = "none"
