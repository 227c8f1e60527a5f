"""Marching the sun's ray through the canopy: what the reference does, in few steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays, Bake
from renderer.forest.land_shadow import shadow_bounds, stand_tops_bake
from renderer.forest.shadow.voxel_transmittance import VoxelTransmittance
from renderer.forest.technique import ForestTechnique
from renderer.world.sun import angles

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


class SunMarch(ForestTechnique):
    """Transmittance along the sun's ray through the true canopy, in steps of a voxel or two, to the last ridge."""

    title: ClassVar[str] = "Sun march"
    caption: ClassVar[str] = "Follows the sun's ray through the trees themselves, coarser as it goes."
    paper: ClassVar[str] = "Levoy 1990; Crassin et al. 2011 (cone tracing)"
    textures: ClassVar[Mapping[str, str]] = {"land": "sampler2D", "voxels": "sampler3D"}

    kind: Literal["sun_march"] = "sun_march"
    step: float = param(
        1.5, label="First step", help="Length of the first step, of the pattern's voxels.", unit="voxel", ge=0.25, le=8
    )
    growth: float = param(
        0.05,
        label="Growth",
        help="How much longer each step is than the one before, after the first 32.",
        unit="ratio",
        ge=0,
        le=1,
        source="Crassin et al. 2011, section 5 (cone aperture)",
    )
    bias: float = param(
        -1.5,
        label="Level bias",
        help="Added to the mip level whose voxels are as long as the step; negative is sharper.",
        ge=-4,
        le=2,
        step=0.25,
    )
    stop: float = param(
        0.02, label="Early stop", help="Transmittance below which the rest is dark.", unit="ratio", ge=0, le=0.5
    )

    blocks: int = param(
        0,
        label="First look",
        help="Pixels a side of the blocks that share one ray in the first sample, which is smoothed; 1: each has one; "
        "0: none has, what the voxels know of the sun stands for it.",
        unit="px",
        cost="host",
        ge=0,
        le=4,
    )

    def first_look(self) -> int:
        """Blocks, unless each pixel has a ray of its own; 1 where none needs one."""
        return {0: 1, 1: 0}.get(self.blocks, self.blocks)

    def first_sample(self) -> ForestTechnique:
        """Voxels' transmittance: it errs by less than one ray for nine pixels is noisy, and asks for no ray."""
        return VoxelTransmittance() if self.blocks == 0 else self

    def bakes(self, state: ForestState, terrain: Bake, pattern: Bake) -> list[Bake]:
        """The tops of the stands, and what the first sample needs."""
        first = VoxelTransmittance().bakes(state, terrain, pattern) if self.blocks == 0 else []
        return [stand_tops_bake(terrain, pattern), *first]

    def kept_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, Sequence[np.ndarray]]:
        """Opacity, foot and rank of each voxel, half of what the view ray reads: the march looks everywhere."""
        pattern = baked["pattern"]
        levels = [(pattern[f"colour{end}"], pattern[f"anchor{end}"]) for end in ("", "_1", "_2", "_3", "_4", "_5")]
        return {"voxels": [sunward(colour, anchor) for colour, anchor in levels]}

    def frame_key(self, state: ForestState) -> tuple[Any, ...]:
        """The sun for which the land's shadow is swept."""
        return ("bounds", *(round(angle, 7) for angle in angles(state.sun)))

    def frame_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Bounds [m] of the shadow of land and stands, (N, N, 2)."""
        return {"land": shadow_bounds(baked["terrain"], baked["stand_tops"]["tops"], angles(state.sun))}


def sunward(colour: np.ndarray, anchor: np.ndarray) -> np.ndarray:
    """What a ray to the sun reads of a voxel, (K, J, I, 4) bytes: opacity, foot east and north, rank; where there is no
    opacity, the voxels that are free all around in the place of the foot."""
    opacity = colour[..., 3]
    return np.stack(
        [opacity, np.where(opacity == 0, anchor[..., 2], anchor[..., 0]), anchor[..., 1], anchor[..., 3]], -1
    )
