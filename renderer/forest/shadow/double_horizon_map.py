"""Double horizon maps (Cohen 2004, section 3.1): the thesis' own technique."""

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


class DoubleHorizonMap(ForestTechnique):
    """Two horizon maps, at the canopy's top and halfway, interpolated by the height of the point."""

    title: ClassVar[str] = "Double horizon map"
    caption: ClassVar[str] = "A horizon at the treetops, another halfway down, blended by height."
    paper: ClassVar[str] = "Cohen 2004, section 3.1"
    textures: ClassVar[Mapping[str, str]] = {"terrain": "sampler2D", "canopy": "sampler2D"}
    wrap: ClassVar[Mapping[str, Literal["clamp", "repeat"]]] = {"canopy": "repeat"}

    extra_declarations: ClassVar[tuple[str, ...]] = (
        "uniform float shadow_low; // normalised height of the low map",
        "uniform float shadow_top; // normalised height of the top map",
    )

    kind: Literal["double_horizon_map"] = "double_horizon_map"
    sectors: Literal[4, 8, 16, 32] = param(
        16,
        label="Sectors",
        help="Azimuth sectors of the maps; the thesis has 4.",
        cost="bake",
        source="Cohen 2004, section 3.1",
    )
    height_top: float = param(
        0.7,
        label="Height of the top map",
        help="Normalised canopy height of the upper probes: the treetops.",
        unit="ratio",
        cost="bake",
        ge=0.05,
        le=1,
        source="Cohen 2004, section 3.1",
    )
    height_low: float = param(
        0.35,
        label="Height of the low map",
        help="Normalised canopy height of the lower probes.",
        unit="ratio",
        cost="bake",
        ge=0,
        le=0.95,
        source="Cohen 2004, section 3.1; errata 000-1",
    )
    softness: float = param(
        3.0,
        label="Half penumbra",
        help="Half width of the soft threshold; 9 in the thesis, 0.27 the sun's own radius.",
        unit="deg",
        ge=0.01,
        le=20,
        source="Cohen 2004, listing 10.1; errata 000-2",
    )
    strength: float = param(
        1.0, label="Strength", help="Share of the shadow.", unit="ratio", ge=0, le=1, source="Cohen 2004, section 5.4"
    )
    floor_low: float = param(
        0.0,
        label="Least angle of the low map",
        help="At 90 the lower layers are always dark, as empirical height shading has them.",
        unit="deg",
        ge=0,
        le=90,
        source="Cohen 2004, section 3.2",
    )
    bound: float = param(
        1.0,
        label="Upper bound",
        help="Light of a place in the sun; 1.5 where this stands for empirical height shading.",
        unit="ratio",
        ge=1,
        le=2,
        source="Cohen 2004, section 3.2",
    )

    def bakes(self, state: ForestState, terrain: Bake, pattern: Bake) -> list[Bake]:
        """The terrain's horizon and the canopy's, in this many sectors."""
        return [
            terrain_horizon_bake(terrain, self.sectors),
            canopy_horizon_bake(pattern, self.sectors, [self.height_top, self.height_low]),
        ]

    def frame_key(self, state: ForestState) -> tuple[Any, ...]:
        """The maps in use and the azimuth at which they are read."""
        return (self.kind, self.sectors, self.height_top, self.height_low, round(angles(state.sun)[0], 7))

    def frame_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Horizon elevation [rad] at the sun's azimuth: `terrain` (N, N) and `canopy` (J, I[, 2])."""
        azimuth = angles(state.sun)[0]
        canopy = canopy_at(baked["canopy_horizon"]["sectors"], azimuth, 2)
        return {"terrain": terrain_at(baked["terrain_horizon"], azimuth), "canopy": canopy}

    def constants(self) -> dict[str, float]:
        """The height that the low map was baked for."""
        return {"shadow_low": self.height_low, "shadow_top": max(self.height_top, self.height_low + 0.01)}
