"""Sky light by the ambient share stored with the pattern."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.forest.technique import ForestTechnique


class Ambient(ForestTechnique):
    """Sky irradiance of the moment times the share of the sky that reaches the voxel."""

    title: ClassVar[str] = "Ambient of the pattern"
    caption: ClassVar[str] = "The sky's own light, dimmed by the foliage around each voxel."
    paper: ClassVar[str] = "Cohen 2004, section 2.1 (ambient colour per voxel); sky after Hillaire 2020"

    kind: Literal["ambient"] = "ambient"
