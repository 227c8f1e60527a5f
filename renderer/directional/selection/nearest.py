"""The points of the nearest direction."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.directional.technique import TexelSelection


class Nearest(TexelSelection):
    """Each texel of the faces shows the point it sees from the nearest direction of its hemisphere."""

    title: ClassVar[str] = "Nearest direction"
    caption: ClassVar[str] = "Each texel shows what it sees from the nearest direction: cheapest, but edges leap."
    paper: ClassVar[str] = "Porquet 2005, section on illumination models; Porquet, Dischler & Ghazanfarpour 2005"

    kind: Literal["nearest"] = "nearest"
