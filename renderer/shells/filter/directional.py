"""Levels whose voxels hide by the direction in which they are looked through."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.technique import ShellsTechnique


class Directional(ShellsTechnique):
    """Each coarse voxel knows how much it hides along each of the texture's axes."""

    title: ClassVar[str] = "Directional"
    caption: ClassVar[str] = "Coarser voxels for what is small on the screen, which hide by the direction of the ray."
    paper: ClassVar[str] = "Heitz et al. 2015, equation 2"
    textures: ClassVar[dict[str, str]] = {"beside": "sampler3D"}
    includes: ClassVar[tuple[str, ...]] = ("shells/footprint.glsl",)
    levels: ClassVar[str] = "directional"

    kind: Literal["directional"] = "directional"
    bias: float = param(-3.0, label="Bias", help="Levels coarser than a pixel asks for.", ge=-4, le=4)
