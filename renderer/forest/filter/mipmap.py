"""Mip levels of the pattern, chosen by the pixel's width at the point."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.forest.technique import ForestTechnique


class Mipmap(ForestTechnique):
    """Coarser voxels as the pixel widens, as high as the finest; matter counts by the light that reaches it."""

    title: ClassVar[str] = "Mip levels"
    caption: ClassVar[str] = "Voxels as wide as the pixel: steady and cheaper far away."
    paper: ClassVar[str] = "Williams 1983; Meyer & Neyret 1998; Cohen 2004, section 6.5"

    kind: Literal["mipmap"] = "mipmap"
    bias: float = param(
        0.5, label="Level bias", help="Added to the level; negative is sharper.", unit="", ge=-3, le=3, step=0.25
    )
