"""Lambert's law by each voxel's own normal."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.shells.technique import ShellsTechnique


class Lambert(ShellsTechnique):
    """Matter reflects as matt paper does, by the normal that its voxel holds; glowing voxels shine, too."""

    title: ClassVar[str] = "Lambert"
    caption: ClassVar[str] = "Each voxel reflects by its own normal, as matt paper does; glowing voxels shine."
    paper: ClassVar[str] = "Dufort 2005, section 5.3.1"

    kind: Literal["lambert"] = "lambert"
