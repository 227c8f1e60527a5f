"""What every map drawn from the sun shares: its light, its parameters and its pass."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays
from renderer.forest.sun_view import Light, light_of, or_whole_land, visible_points
from renderer.forest.technique import ForestTechnique
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, REACH
from renderer.world.sun import direction

if TYPE_CHECKING:
    from renderer.forest.state import ForestState

LIGHT_DECLARATIONS = (
    "uniform vec3 shadow_right; // unit vector across the light, horizontal",
    "uniform vec3 shadow_up; // unit vector across the light",
)

AWAY = "uniform float shadow_away; // m, sunward coordinate beyond which nothing casts a shadow"

PASS_DECLARATIONS = (AWAY, "uniform float shadow_threshold; // opacity")


class SunView(ForestTechnique):
    """What looks at the visible land along the sun's light."""

    def light(self, state: ForestState, baked: Mapping[str, Arrays]) -> Light:
        """The sun's light over the land."""
        return light_of(direction(state.sun), baked["terrain"], CELL, CANOPY_HEIGHT)

    def seen(self, state: ForestState, baked: Mapping[str, Arrays], size: tuple[int, int]) -> np.ndarray:
        """Points (P, 3) that the camera sees [m], or the whole land's corners."""
        ground = baked["terrain"]
        points = visible_points(state.camera, ground, CELL, CANOPY_HEIGHT, REACH, size)
        return or_whole_land(points, ground, CELL, CANOPY_HEIGHT)

    def light_uniforms(self, light: Light) -> dict[str, Any]:
        """Values of `LIGHT_DECLARATIONS` and `AWAY`."""
        return {
            "shadow_right": tuple(map(float, light.right)),
            "shadow_up": tuple(map(float, light.up)),
            "shadow_away": light.away,
        }


class SunMap(SunView):
    """A map of what the sun meets first, over what the camera sees."""

    textures: ClassVar[Mapping[str, str]] = {"depth": "sampler2D"}

    threshold: float = param(
        0.3,
        label="Opacity threshold",
        help="Opacity gathered along the sun's way from which matter casts a shadow: shadows start inside the crowns.",
        unit="ratio",
        cost="host",
        ge=0.01,
        le=0.99,
        source="Cohen 2004, section 5.1",
    )
    bias: float = param(
        0.5, label="Bias", help="How far behind the first matter light still arrives.", unit="m", ge=0, le=10
    )
    texel_bias: float = param(
        0.3, label="Bias by texel", help="The same for each metre of a texel's width.", unit="ratio", ge=0, le=4
    )
    strength: float = param(1.0, label="Strength", help="Share of the shadow.", unit="ratio", ge=0, le=1)

    def light_uniforms(self, light: Light) -> dict[str, Any]:
        """Values of `LIGHT_DECLARATIONS` and `PASS_DECLARATIONS`."""
        return {**super().light_uniforms(light), "shadow_threshold": self.threshold}
