"""No shadow of the clouds."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.clouds.technique import CloudsTechnique


class NoCloudShadow(CloudsTechnique):
    """The ground as under a clear sky."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = (
        "Sun and sky reach the ground as if there were no clouds. The zero against which shadows are judged."
    )
    includes: ClassVar[tuple[str, ...]] = ("clouds/shade.glsl",)
    paper: ClassVar[str] = "-"

    kind: Literal["none"] = "none"
