"""The shadow of what stands overhead."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.clouds.technique import CloudsTechnique


class Overhead(CloudsTechnique):
    """A light map painted straight down."""

    title: ClassVar[str] = "Overhead"
    caption: ClassVar[str] = (
        "Each place is shaded by the cloud above it: right under a high sun, kilometres off under a low one."
    )
    includes: ClassVar[tuple[str, ...]] = ("clouds/shade.glsl",)
    paper: ClassVar[str] = "Bouthors, Neyret and Lefebvre 2006"

    kind: Literal["overhead"] = "overhead"
