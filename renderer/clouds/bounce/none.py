"""No light between ground and clouds."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.clouds.technique import CloudsTechnique


class NoBounce(CloudsTechnique):
    """The clouds' base sees a black ground, and the ground nothing that comes back."""

    title: ClassVar[str] = "None"
    caption: ClassVar[str] = (
        "No light goes back and forth: the clouds' base is dark, snow or not. The zero of the bounces."
    )
    paper: ClassVar[str] = "-"

    kind: Literal["none"] = "none"
