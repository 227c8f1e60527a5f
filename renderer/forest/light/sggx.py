"""SGGX microflakes: a matrix a voxel whose mean is its coarser levels' (Heitz et al. 2015)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from renderer.core.technique import Arrays, Bake
from renderer.forest.lobe_levels import levels_of
from renderer.forest.sggx import bake_sggx
from renderer.forest.technique import ForestTechnique

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


class Sggx(ForestTechnique):
    """Diffuse flakes, two-sided and translucent, seen by the area they show."""

    title: ClassVar[str] = "SGGX microflakes"
    caption: ClassVar[str] = "A cloud of flakes a voxel, averaged as the eye steps back: a crown keeps its roundness."
    paper: ClassVar[str] = "Heitz, Dupuy, Crassin & Dachsbacher 2015"

    textures: ClassVar[dict[str, str]] = {"spread": "sampler3D", "lean": "sampler3D"}

    kind: Literal["sggx"] = "sggx"

    def bakes(self, state: ForestState, terrain: Bake, pattern: Bake) -> list[Bake]:
        """The voxels' matrices."""
        return [Bake("sggx", bake_sggx, {}, (pattern,), seconds=4)]

    def kept_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, Sequence[np.ndarray]]:
        """Every level's matrices."""
        return {name: levels_of(baked["sggx"], name) for name in ("spread", "lean")}
