"""Colours in single precision."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.shells.technique import AccumulationTechnique


class Single(AccumulationTechnique):
    """Four bytes a component: nothing is rounded that an eye could see."""

    title: ClassVar[str] = "Single precision"
    caption: ClassVar[str] = "Colours are put together in 32 bits a component."
    paper: ClassVar[str] = "IEEE 754-1985, section 3.2.1"

    kind: Literal["single"] = "single"
    dtype: ClassVar[str] = "f4"
