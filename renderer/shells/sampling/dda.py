"""Every voxel that a segment crosses."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.technique import ShellsTechnique


class Dda(ShellsTechnique):
    """Each voxel with its own length of path: exact where matter is constant in voxels, and nearly so between them."""

    title: ClassVar[str] = "Voxel by voxel"
    caption: ClassVar[str] = "Each voxel that a ray crosses, with its own length of path: none is missed; slow."
    paper: ClassVar[str] = "Amanatides & Woo 1987, section 2"

    kind: Literal["dda"] = "dda"
    most: int = param(
        512, label="Most voxels", help="Of one segment.", cost="build", unit="count", ge=8, le=8192
    )
