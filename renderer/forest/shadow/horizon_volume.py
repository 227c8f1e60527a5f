"""Horizon volume: soft horizons at several heights of the canopy and in many azimuths."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays, Bake
from renderer.forest.bakes import soft_horizon_bake, terrain_horizon_bake
from renderer.forest.horizon_textures import stacked_at, terrain_at
from renderer.forest.technique import ForestTechnique
from renderer.world.sun import angles

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


class HorizonVolume(ForestTechnique):
    """Where the sun comes out of the leaves, and over how wide a range, by place, height and azimuth."""

    title: ClassVar[str] = "Horizon volume"
    caption: ClassVar[str] = "Horizons at many heights and azimuths, each with its own softness."
    paper: ClassVar[str] = "After Max 1988 and Cohen 2004, section 3.1: more heights and sectors, and a fitted penumbra"
    textures: ClassVar[Mapping[str, str]] = {"terrain": "sampler2D", "canopy": "sampler2D"}
    wrap: ClassVar[Mapping[str, Literal["clamp", "repeat"]]] = {"canopy": "repeat"}

    extra_declarations: ClassVar[tuple[str, ...]] = (
        "uniform float shadow_highest; // normalised height of the highest probes",
        "uniform float shadow_levels;  // heights",
    )

    kind: Literal["horizon_volume"] = "horizon_volume"
    sectors: Literal[4, 8, 16, 32] = param(
        16, label="Sectors", help="Azimuths of the horizons.", cost="bake", source="Cohen 2004, section 3.1"
    )
    levels: int = param(
        12, label="Heights", help="Heights of the probes, from the ground up.", unit="count", cost="bake", ge=2, le=24
    )
    highest: float = param(
        0.85,
        label="Highest probes",
        help="Normalised canopy height of the highest probes: the treetops.",
        unit="ratio",
        cost="bake",
        ge=0.1,
        le=1,
    )
    strength: float = param(
        1.0, label="Strength", help="Share of the shadow.", unit="ratio", ge=0, le=1, source="Cohen 2004, section 5.4"
    )

    def bakes(self, state: ForestState, terrain: Bake, pattern: Bake) -> list[Bake]:
        """The terrain's horizon, and the canopy's at these heights."""
        heights = [self.highest * level / (self.levels - 1) for level in range(self.levels)]
        return [terrain_horizon_bake(terrain, self.sectors), soft_horizon_bake(pattern, self.sectors, heights)]

    def frame_key(self, state: ForestState) -> tuple[Any, ...]:
        """The horizons in use and the azimuth at which they are read."""
        return (self.kind, self.sectors, self.levels, self.highest, round(angles(state.sun)[0], 7))

    def frame_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """`terrain` (N, N) [rad] at the sun's azimuth, and `canopy`, as `stacked_at` lays it."""
        azimuth = angles(state.sun)[0]
        return {
            "terrain": terrain_at(baked["terrain_horizon"], azimuth),
            "canopy": stacked_at(baked["soft_horizon"]["soft"], azimuth),
        }

    def constants(self) -> dict[str, float]:
        """The heights that were baked."""
        return {"shadow_highest": self.highest, "shadow_levels": float(self.levels)}
