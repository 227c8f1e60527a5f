"""Leaves as thin sheets that reflect the sun and let it through (Ross 1981; Shultis & Myneni 1988)."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.forest.technique import ForestTechnique


class Leaf(ForestTechnique):
    """Two-sided leaves, lying as the voxel's normals do: what the reference computes."""

    title: ClassVar[str] = "Thin leaves"
    caption: ClassVar[str] = "Leaves reflect on the lit side and glow on the other: crowns shine against the sun."
    paper: ClassVar[str] = "Ross 1981; Shultis & Myneni 1988"

    kind: Literal["leaf"] = "leaf"
