"""Perspective shadow map: drawn in the camera's post-projective space (Stamminger & Drettakis 2002)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays
from renderer.forest.perspective_view import perspective_map
from renderer.forest.sun_map import LIGHT_DECLARATIONS, PASS_DECLARATIONS, SunMap
from renderer.forest.technique import SunPass
from renderer.world.sun import direction

if TYPE_CHECKING:
    from renderer.forest.state import ForestState

MAP_DECLARATIONS = (
    "uniform vec2 shadow_anchor; // m, across the light",
    "uniform mat3 shadow_to_map; // (right, up, 1) after the anchor [m] to the map, [0, 1] after division",
    "uniform mat3 shadow_to_light; // and back",
)


class PerspectiveShadowMap(SunMap):
    """A depth map whose texels are as fine as the camera's pixels where the eye is near, and coarse far off."""

    title: ClassVar[str] = "Perspective shadow map"
    caption: ClassVar[str] = (
        "Texels follow the eye: fine near, coarse far. The whole map changes with the camera: it vibrates."
    )
    paper: ClassVar[str] = "Stamminger & Drettakis 2002; Cohen 2004, section 5.1"
    extra_declarations: ClassVar[tuple[str, ...]] = (*LIGHT_DECLARATIONS, *MAP_DECLARATIONS)

    kind: Literal["perspective_shadow_map"] = "perspective_shadow_map"
    resolution: Literal[512, 1024, 2048, 4096] = param(
        512, label="Resolution", help="Texels a side of the map.", unit="px", cost="host"
    )
    slide: float = param(
        0.0,
        label="Slide back",
        help="How far the eye is slid back for the map: more texels for what is far, fewer for what is near.",
        unit="m",
        cost="host",
        ge=0,
        le=100000,
        source="Stamminger & Drettakis 2002, section 4",
    )

    def sun_pass(self, state: ForestState, baked: Mapping[str, Arrays], size: tuple[int, int]) -> SunPass | None:
        """The depth pass over what the camera sees, in the space after its projection."""
        light = self.light(state, baked)
        found = perspective_map(state.camera, self.seen(state, baked, size), light, direction(state.sun), self.slide)
        uniforms: dict[str, Any] = {
            **self.light_uniforms(light),
            "shadow_anchor": tuple(map(float, found.anchor)),
            "shadow_to_map": rows(found.to_map),
            "shadow_to_light": rows(found.to_light),
            "shadow_resolution": float(self.resolution),
        }
        declarations = (*self.extra_declarations, *PASS_DECLARATIONS, "uniform float shadow_resolution;")
        glsl = "forest/shadow/perspective_shadow_map_depth.glsl"
        return SunPass("depth", glsl, declarations, self.resolution, uniforms)


def rows(matrix: np.ndarray) -> tuple[tuple[float, ...], ...]:
    """A matrix as plain numbers, which can be compared."""
    return tuple(tuple(map(float, row)) for row in matrix)
