"""Matter that scatters light within itself, once and on and on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from renderer.core.params import param
from renderer.core.technique import Arrays, Bake
from renderer.shells.technique import ShellsTechnique
from renderer.shells.texture.sources import moment_of, texture_bake
from renderer.shells.transfer import bake_transfer


class Scattering(ShellsTechnique):
    """Light once scattered exactly, and what is scattered on from what was precomputed of the texture's block."""

    title: ClassVar[str] = "Scattering"
    caption: ClassVar[str] = "Light goes on from voxel to voxel: the first time exactly, later by precomputed transfer."
    paper: ClassVar[str] = "Henyey & Greenstein 1941; Sloan, Kautz & Snyder 2002"
    textures: ClassVar[dict[str, str]] = {"transfer": "sampler3D"}
    tables: ClassVar[dict[str, tuple[str, str]]] = {"transfer": ("transfer", "table")}
    extra_declarations: ClassVar[tuple[str, ...]] = ("uniform float light_lobe; // mean cosine of the phase function",)

    kind: Literal["scattering"] = "scattering"
    asymmetry: float = param(
        0.6, label="Asymmetry", help="Mean cosine of the angle by which matter scatters.", cost="bake", ge=-0.95,
        le=0.95, source="Henyey and Greenstein 1941",
    )
    across: int = param(
        32, label="Transfer voxels", help="Along the longest side of the block.", unit="voxel", cost="bake", ge=4, le=64
    )
    walks: int = param(
        192, label="Walks", help="From each of these voxels.", unit="count", cost="bake", ge=16, le=4096
    )

    def bakes(self, state: Any) -> list[Bake]:
        """The transfer of the block under the state's own growth and opacities, whatever key frames make of them."""
        arguments = {
            "thickness": state.extrusion.thickness,
            "density": state.voxels.density,
            "moment": moment_of(state.texture),
            "repeats": state.voxels.wrap == "repeat",
            "base": list(state.base.colour) if state.base.opaque else None,
            "asymmetry": self.asymmetry,
            "across": self.across,
            "walks": self.walks,
        }
        return [Bake("transfer", bake_transfer, arguments, (texture_bake(state.texture),), version=3, seconds=8)]

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """The lobe that was baked."""
        return {"light_lobe": self.asymmetry}
