"""Sectors of the hemisphere by patterns learnt of the cloud."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.directional.self_shadowing import BookTechnique


class Codebook(BookTechnique):
    """Eight numbers a point, each of a sector's pattern in a book learnt of this cloud."""

    title: ClassVar[str] = "Learnt patterns"
    caption: ClassVar[str] = "Eighths of each hemisphere by the number of a pattern that the subject's shadows taught."
    paper: ClassVar[str] = "Linde, Buzo & Gray 1980, An algorithm for vector quantizer design"

    kind: Literal["codebook"] = "codebook"
    size: Literal[5, 9] = param(
        9, label="Bytes", help="Of a point, and bits of a sector: 32 or 512 patterns.", unit="count", cost="build"
    )
    blend: bool = param(
        True,
        label="Blend directions",
        help="Mix the four directions around the light's, rather than take the nearest.",
        cost="build",
    )
