"""Levels of the texture by the width of a pixel."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.technique import ShellsTechnique


class Mipmap(ShellsTechnique):
    """The level whose voxels are as wide as a pixel."""

    title: ClassVar[str] = "Mip levels"
    caption: ClassVar[str] = "Coarser voxels for what is small on the screen, put together across and in height."
    paper: ClassVar[str] = "Dufort 2005, section 5.3.2"
    includes: ClassVar[tuple[str, ...]] = ("shells/footprint.glsl",)

    kind: Literal["mipmap"] = "mipmap"
    levels: Literal["thesis", "above", "mean"] = param(
        "thesis",
        label="Coarser voxels",
        cost="host",
        help="How they are made: opacities put together as in the thesis, what the light from above meets, or means.",
    )
    bias: float = param(-3.0, label="Bias", help="Levels coarser than a pixel asks for.", ge=-4, le=4)
