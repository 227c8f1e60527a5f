"""Matter that shines by itself."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.technique import ShellsTechnique


class Unlit(ShellsTechnique):
    """Emission and absorption alone."""

    title: ClassVar[str] = "Unlit"
    caption: ClassVar[str] = "Matter shines with its own colour: emission and absorption alone."
    paper: ClassVar[str] = "Max 1995, section 2.3"

    kind: Literal["unlit"] = "unlit"
    level: float = param(
        1.0, label="Level", help="Radiance of white matter.", unit="W m-2 sr-1", ge=0, le=1e6
    )
