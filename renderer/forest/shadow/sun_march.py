"""Marching the sun's ray through the canopy: what the reference does, in few steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays
from renderer.forest.land_shadow import land_shadow
from renderer.forest.technique import ForestTechnique
from renderer.world.sun import angles

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


class SunMarch(ForestTechnique):
    """Transmittance along the sun's ray through the true canopy, in steps and voxels that grow with the distance."""

    title: ClassVar[str] = "Sun march"
    caption: ClassVar[str] = "Follows the sun's ray through the trees themselves, coarser as it goes."
    paper: ClassVar[str] = "Levoy 1990; Crassin et al. 2011 (cone tracing)"
    textures: ClassVar[Mapping[str, str]] = {"land": "sampler2D", "voxels": "sampler3D"}

    kind: Literal["sun_march"] = "sun_march"
    step: float = param(
        1.5, label="First step", help="Length of the first step, of the pattern's voxels.", unit="voxel", ge=0.25, le=8
    )
    growth: float = param(
        0.4,
        label="Growth",
        help="How much longer each step is than the one before.",
        unit="ratio",
        ge=0,
        le=1,
        source="Crassin et al. 2011, section 5 (cone aperture)",
    )
    bias: float = param(
        -1.0,
        label="Level bias",
        help="Added to the mip level whose voxels are as long as the step; negative is sharper.",
        ge=-4,
        le=2,
        step=0.25,
    )
    stop: float = param(
        0.02, label="Early stop", help="Transmittance below which the rest is dark.", unit="ratio", ge=0, le=0.5
    )

    def kept_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, Sequence[np.ndarray]]:
        """Opacity, foot and rank of each voxel, half of what the view ray reads: the march looks everywhere."""
        pattern = baked["pattern"]
        levels = [(pattern[f"colour{end}"], pattern[f"anchor{end}"]) for end in ("", "_1", "_2", "_3", "_4", "_5")]
        return {"voxels": [np.concatenate([c[..., 3:], a[..., [0, 1, 3]]], axis=-1) for c, a in levels]}

    def frame_key(self, state: ForestState) -> tuple[Any, ...]:
        """The sun for which the land's shadow is swept."""
        return ("land", *(round(angle, 7) for angle in angles(state.sun)))

    def frame_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Height [m] of the land's shadow, (N, N)."""
        return {"land": land_shadow(baked["terrain"], angles(state.sun))}
