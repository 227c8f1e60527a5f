"""Rays that walk from every lit place to the sun."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.sun_curves import SunCurves


class SunWalk(SunCurves):
    """Each lit place sends a ray through the cells towards the sun: nearly exact, and slow; for stills."""

    title: ClassVar[str] = "Walk to the sun"
    caption: ClassVar[str] = "From each lit place a ray walks through the cells to the sun: exact, for stills."
    paper: ClassVar[str] = "Kajiya & Von Herzen 1984, section 3"

    kind: Literal["sun_walk"] = "sun_walk"
    rate: float = param(2.0, label="Rate", help="Samples a voxel on the way.", ge=0.1, le=16)
