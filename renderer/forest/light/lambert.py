"""Lambert light with the voxel's own normal (Cohen 2004, sections 2.1 and 7.2)."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.forest.technique import ForestTechnique


class Lambert(ForestTechnique):
    """Cosine between the sun and the mean normal stored in the voxel."""

    title: ClassVar[str] = "Lambert"
    caption: ClassVar[str] = "Each voxel's own mean normal: crowns become round."
    paper: ClassVar[str] = "Blinn 1978; Cohen 2004, section 7.2"

    kind: Literal["lambert"] = "lambert"
