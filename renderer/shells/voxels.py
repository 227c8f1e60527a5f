"""How the shell's texture is read, and the surface that it stands on: parameters."""

from __future__ import annotations

from typing import Literal

from renderer.core.params import Colour, Model, param

Interpolation = Literal["nearest", "straight", "extinction"]


class Voxels(Model):
    """How the 3D texture is read."""

    interpolation: Interpolation = param(
        "straight",
        label="Interpolation",
        cost="host",
        help="Between voxels: none; of colour and alpha, each by itself; or of extinction and what it weighs.",
        source="Dufort 2005, section 3.2",
    )
    wrap: Literal["repeat", "clamp"] = param(
        "repeat", label="Wrap", cost="host", help="What lies beyond the texture's edges along u and v."
    )
    storage: Literal["auto", "bytes", "half", "float"] = param(
        "auto",
        label="Storage",
        cost="host",
        help="Type of the voxels' numbers on the GPU; auto takes bytes where they hold what is interpolated.",
    )
    density: float = param(
        1.0, label="Density", cost="live", help="Extinction against the texture's own.", ge=0, le=100
    )
    glow: float = param(
        3000.0,
        label="Glow",
        unit="W m-2 sr-1",
        help="Radiance of white voxels that glow.",
        ge=0,
        le=1e6,
    )


class Base(Model):
    """The surface under the shell."""

    opaque: bool = param(
        True, label="Opaque", cost="host", help="Whether the surface hides what is behind it; else the shell is hollow."
    )
    colour: Colour = param((0.35, 0.33, 0.3), label="Colour", help="Its linear reflectance.")
