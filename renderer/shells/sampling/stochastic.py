"""Opacity from nearest voxels moved by chance, light at a few places of a ray."""

from __future__ import annotations

from typing import Any, ClassVar, Literal

from renderer.core.params import param
from renderer.core.technique import Bake
from renderer.shells.technique import ShellsTechnique
from renderer.shells.texture.sources import texture_bake
from renderer.shells.texture.strides import DECLARATIONS, strides_bake


class Stochastic(ShellsTechnique):
    """What is interpolated, and what is lit, is chosen by chance, so that its mean over pictures is the whole."""

    title: ClassVar[str] = "Stochastic"
    caption: ClassVar[str] = "Nearest voxels of places moved by chance; light at a few of a ray, by what is seen."
    paper: ClassVar[str] = "Pharr, Wronski, Salvi & Fajardo 2024, section 3"
    textures: ClassVar[dict[str, str]] = {"voxels": "sampler3D"}
    extra_declarations: ClassVar[tuple[str, ...]] = (DECLARATIONS,)
    whole: ClassVar[bool] = True

    kind: Literal["stochastic"] = "stochastic"
    rate: float = param(0.7, label="Rate", help="Samples a voxel.", ge=0.05, le=64)
    jitter: float = param(
        1.0, label="Jitter", help="By how much of a step and of a voxel samples move between pictures.", unit="ratio",
        ge=0, le=1,
    )  # fmt: skip
    places: int = param(
        6, label="Places", help="Of a ray that are lit, one of each share of what it sees.", cost="build", unit="count",
        ge=1, le=16,
    )  # fmt: skip
    most: int = param(
        16, label="Most samples", help="Of one segment.", cost="build", unit="count", ge=1, le=4096
    )

    def bakes(self, state: Any) -> list[Bake]:
        """How far rays may go within each voxel's matter."""
        return [strides_bake(texture_bake(state.texture), state.voxels.wrap)]
