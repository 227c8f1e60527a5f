"""Colours in half precision."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.shells.technique import AccumulationTechnique


class Half(AccumulationTechnique):
    """Two bytes a component, rounded after each segment: what the thesis chooses against bands."""

    title: ClassVar[str] = "Half precision"
    caption: ClassVar[str] = "Colours are put together in 16 bits a component: bands only where much is faint."
    paper: ClassVar[str] = "Dufort 2005, section 5.2.2"

    kind: Literal["half"] = "half"
    dtype: ClassVar[str] = "f2"
