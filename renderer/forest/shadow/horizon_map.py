"""Single horizon map (Max 1988; Cohen 2004, section 3.1 before the second map)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays, Bake
from renderer.forest.bakes import canopy_horizon_bake, terrain_horizon_bake
from renderer.forest.horizon_textures import canopy_at, terrain_at
from renderer.forest.technique import ForestTechnique
from renderer.world.sun import angles

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


class HorizonMap(ForestTechnique):
    """One elevation per sector and point, below which the sun is hidden, for the whole thickness of the canopy."""

    title: ClassVar[str] = "Horizon map"
    caption: ClassVar[str] = "Lowest visible sun per sector, stored once for all heights of the canopy."
    paper: ClassVar[str] = "Max 1988; Sloan & Cohen 2000; Cohen 2004, sections 3.1 and 7.2"
    textures: ClassVar[Mapping[str, str]] = {"terrain": "sampler2D", "canopy": "sampler2D"}
    wrap: ClassVar[Mapping[str, Literal["clamp", "repeat"]]] = {"canopy": "repeat"}

    kind: Literal["horizon_map"] = "horizon_map"
    sectors: Literal[4, 8, 16, 32] = param(
        4, label="Sectors", help="Azimuth sectors of the maps.", cost="bake", source="Cohen 2004, section 3.1"
    )
    height: float = param(
        0.7,
        label="Map height",
        help="Normalised canopy height of the map's probes: the treetops; farther down, all below them is black.",
        unit="ratio",
        cost="bake",
        ge=0,
        le=1,
    )
    softness: float = param(
        9.0,
        label="Half penumbra",
        help="Half width of the soft threshold around the horizon.",
        unit="deg",
        ge=0.01,
        le=20,
        source="Cohen 2004, listing 10.1 (0.1 in units of a right angle)",
    )
    strength: float = param(
        1.0, label="Strength", help="Share of the shadow.", unit="ratio", ge=0, le=1, source="Cohen 2004, section 5.4"
    )

    def bakes(self, state: ForestState, terrain: Bake, pattern: Bake) -> list[Bake]:
        """The terrain's horizon and the canopy's, in this many sectors."""
        return [terrain_horizon_bake(terrain, self.sectors), canopy_horizon_bake(pattern, self.sectors, [self.height])]

    def frame_key(self, state: ForestState) -> tuple[Any, ...]:
        """The maps in use and the azimuth at which they are read."""
        return (self.kind, self.sectors, self.height, round(angles(state.sun)[0], 7))

    def frame_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Horizon elevation [rad] at the sun's azimuth: `terrain` (N, N) and `canopy` (J, I[, 2])."""
        azimuth = angles(state.sun)[0]
        return {
            "terrain": terrain_at(baked["terrain_horizon"], azimuth),
            "canopy": canopy_at(baked["canopy_horizon"]["sectors"], azimuth, 1),
        }
