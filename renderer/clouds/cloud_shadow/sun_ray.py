"""The shadow along the sun's ray."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.clouds.technique import CloudsTechnique


class SunRay(CloudsTechnique):
    """The layer's transmittance where the sun's ray crosses it."""

    title: ClassVar[str] = "Sun ray"
    caption: ClassVar[str] = (
        "The layer's transmittance where the way to the sun crosses it; scattered light comes from overhead."
    )
    includes: ClassVar[tuple[str, ...]] = ("clouds/shade.glsl",)
    paper: ClassVar[str] = "Belcour 2009, section 3.3.1"

    kind: Literal["sun_ray"] = "sun_ray"
