"""The finest voxels."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.shells.technique import ShellsTechnique


class NoFilter(ShellsTechnique):
    """The finest voxels, however small they are on the screen."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = "The finest voxels, however small on the screen: they shimmer from afar."
    paper: ClassVar[str] = ""

    kind: Literal["none"] = "none"
