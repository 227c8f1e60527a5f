"""The points of four directions, blended."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.directional.technique import TexelSelection


class Blended(TexelSelection):
    """Each texel blends the points that it sees from the four directions round that of the eye."""

    title: ClassVar[str] = "Blended directions"
    caption: ClassVar[str] = "Four directions laid over each other: no leaps, but ghosts of what lies deep in the box."
    paper: ClassVar[str] = "Porquet 2005, future work; bilinear in azimuth and elevation"
    count: ClassVar[int] = 4

    kind: Literal["blended"] = "blended"
