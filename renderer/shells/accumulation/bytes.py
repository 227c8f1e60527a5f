"""Colours in bytes."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.technique import AccumulationTechnique


class Bytes(AccumulationTechnique):
    """One byte a component, rounded after each segment: bands, and faint matter is lost. Kept to show it."""

    title: ClassVar[str] = "Bytes"
    caption: ClassVar[str] = "Colours are put together in 8 bits a component: bands, and faint matter is lost."
    paper: ClassVar[str] = "Dufort 2005, section 5.2.2"

    kind: Literal["bytes"] = "bytes"
    white: float = param(
        200.0, label="White", help="Radiance of the largest byte.", unit="W m-2 sr-1", ge=1e-3, le=1e6
    )
    dtype: ClassVar[str] = "f1"

    def white_radiance(self) -> float:
        """What the largest byte stands for [W m-2 sr-1]."""
        return self.white
