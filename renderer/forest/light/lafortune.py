"""Lafortune's lobe with coefficients of its own in every voxel (Cohen 2004, chapter 6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays, Bake
from renderer.forest.lobe_levels import bake_lobes, levels_of
from renderer.forest.technique import ForestTechnique

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


class Lafortune(ForestTechnique):
    """One isotropic lobe a voxel, fitted to its leaves; coarser levels averaged or fitted anew."""

    title: ClassVar[str] = "Lafortune lobe"
    caption: ClassVar[str] = "One lobe per voxel: leaves are brightest towards the sun, and glow against it."
    paper: ClassVar[str] = "Lafortune, Foo, Torrance & Greenberg 1997; Cohen 2004, chapter 6"

    textures: ClassVar[dict[str, str]] = {"lobe": "sampler3D"}
    extra_declarations: ClassVar[tuple[str, ...]] = ("uniform float light_stored;  // 1: the voxel's own lobe",)

    kind: Literal["lafortune"] = "lafortune"
    coefficients: Literal["refitted", "averaged", "uniform"] = param(
        "refitted",
        label="Coefficients",
        help="Of each voxel, its coarser levels fitted anew or averaged; or the three below everywhere.",
        cost="host",
        source="Cohen 2004, sections 6.3 and 6.5",
    )
    cxy: float = param(
        0.86,
        label="Across (Cxy)",
        help="Weight of the directions across the normal, where uniform: above 0 light returns, below 0 it mirrors.",
        ge=-1.5,
        le=1.5,
        source="Cohen 2004, section 6.3",
    )
    cz: float = param(
        0.77,
        label="Along (Cz)",
        help="Weight of the direction along the normal, where uniform.",
        ge=-1.5,
        le=1.5,
        source="Cohen 2004, section 6.3",
    )
    n: float = param(
        0.5,
        label="Exponent (n)",
        help="Sharpness of the lobe, where uniform.",
        gt=0,
        le=100,
        source="Cohen 2004, section 6.3",
    )

    def bakes(self, state: ForestState, terrain: Bake, pattern: Bake) -> list[Bake]:
        """The voxels' lobes."""
        # Where all are alike, the averaged ones are made soonest.
        levels = "refitted" if self.coefficients == "refitted" else "averaged"
        return [Bake("lobes", bake_lobes, {"levels": levels}, (pattern,), seconds=15 if levels == "refitted" else 2)]

    def kept_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, Sequence[np.ndarray]]:
        """Every level's lobes."""
        return {"lobe": levels_of(baked["lobes"], "lobe")}

    def constants(self) -> dict[str, Any]:
        """Whether the voxels' own lobes count."""
        return {"light_stored": 0.0 if self.coefficients == "uniform" else 1.0}
