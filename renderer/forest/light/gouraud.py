"""Gouraud light: the terrain's own normal lights the canopy above it."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.forest.technique import ForestTechnique


class Gouraud(ForestTechnique):
    """Cosine between the sun and the interpolated normal of the ground under the point."""

    title: ClassVar[str] = "Gouraud"
    caption: ClassVar[str] = "Lights the canopy as the slope it stands on: relief shows, trees stay flat."
    paper: ClassVar[str] = "Gouraud 1971; Cohen 2004, sections 3.1 and 10.1"

    kind: Literal["gouraud"] = "gouraud"
    strength: float = param(
        1.0,
        label="Strength",
        help="Weight of the slope's cosine; the rest is a constant 1.",
        unit="ratio",
        ge=0,
        le=1,
        source="Cohen 2004, section 5.4",
    )
