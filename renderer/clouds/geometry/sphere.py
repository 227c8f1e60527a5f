"""Apparent thickness on the sphere."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.clouds.technique import CloudsTechnique


class Sphere(CloudsTechnique):
    """The layer as a shell: right from the ground to space, and at the limb."""

    title: ClassVar[str] = "Sphere"
    caption: ClassVar[str] = (
        "The layer is a shell round the planet: a ray's path through it is that of the sphere, from any camera."
    )
    paper: ClassVar[str] = "Belcour 2009, section 4.2"

    kind: Literal["sphere"] = "sphere"
