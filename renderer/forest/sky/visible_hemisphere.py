"""Sky light by the part of the hemisphere that trees and land leave visible, under the sky's radiance by direction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.technique import Arrays, Bake
from renderer.forest.technique import ForestTechnique
from renderer.forest.visible_sky import canopy_sky_bake, land_sky_bake

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


class VisibleHemisphere(ForestTechnique):
    """Visibility of the sky as a linear function of the direction, times the moments of the sky's radiance."""

    title: ClassVar[str] = "Visible hemisphere"
    caption: ClassVar[str] = "Each leaf is lit from where it sees the sky, past its trees and over the land's horizon."
    paper: ClassVar[str] = "Dozier & Frew 1990; Ramamoorthi & Hanrahan 2001; sky after Hillaire 2020"
    textures: ClassVar[Mapping[str, str]] = {"seen": "sampler3D", "land": "sampler2D"}
    extra_declarations: ClassVar[tuple[str, ...]] = (
        "uniform vec3 sky_even;  // moments of the sky's radiance, see visible_hemisphere.glsl, W m-2",
        "uniform vec3 sky_upward;",
        "uniform vec3 sky_sunward;",
        "uniform vec3 sky_upward2;",
        "uniform vec3 sky_sunward2;",
        "uniform vec3 sky_across2;",
        "uniform vec3 sky_upward_sunward;",
    )

    kind: Literal["visible_hemisphere"] = "visible_hemisphere"

    def bakes(self, state: ForestState, terrain: Bake, pattern: Bake) -> list[Bake]:
        """What voxels and nodes see of the sky."""
        return [canopy_sky_bake(pattern), land_sky_bake(terrain)]

    def frame_key(self, state: ForestState) -> tuple[Any, ...]:
        """Nothing of the moment: the sky's own light comes as uniforms."""
        return (self.kind,)

    def frame_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """`land` (N, N, 4) bytes, row 0 at the south."""
        return {"land": np.ascontiguousarray(np.asarray(baked["land_sky"]["seen"])[::-1])}

    def kept_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, Sequence[np.ndarray]]:
        """`seen` (K, J, I, 4) bytes of the canopy."""
        return {"seen": [np.asarray(baked["canopy_sky"]["seen"])]}
