"""For each point the code that misjudges it least."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.directional.self_shadowing import BookTechnique


class Chosen(BookTechnique):
    """A ring of horizons where that is exact, else the best of three sets of learnt patterns: nine bytes a point."""

    title: ClassVar[str] = "Best for each point"
    caption: ClassVar[str] = "Each point has the code that misjudges it least: a horizon, or patterns of its kind."
    paper: ClassVar[str] = "After Linde, Buzo & Gray 1980; Max 1988"
    includes: ClassVar[tuple[str, ...]] = (*BookTechnique.includes, "directional/shadow_ring.glsl")

    kind: Literal["chosen"] = "chosen"
    blend: bool = param(
        True,
        label="Blend directions",
        help="Mix the four directions around the light's, rather than take the nearest.",
        cost="build",
    )
