"""Depth shadow map of the canopy (Williams 1978; Cohen 2004, section 5.1)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from renderer.core.params import param
from renderer.core.technique import Arrays
from renderer.forest.sun_view import fit, visible_points
from renderer.forest.technique import ForestTechnique, SunPass
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, REACH
from renderer.world.sun import direction

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


class DepthShadowMap(ForestTechnique):
    """Distance from the sun to the first voxel more opaque than a threshold, over what the camera sees."""

    title: ClassVar[str] = "Depth shadow map"
    caption: ClassVar[str] = (
        "First thing the sun sees, per texel: crisp in a still picture, restless when the sun moves."
    )
    paper: ClassVar[str] = "Williams 1978; Cohen 2004, section 5.1"
    textures: ClassVar[Mapping[str, str]] = {"depth": "sampler2D"}
    extra_declarations: ClassVar[tuple[str, ...]] = (
        "uniform vec3 shadow_corner; // m",
        "uniform vec3 shadow_right; // m",
        "uniform vec3 shadow_up; // m",
    )

    kind: Literal["depth_shadow_map"] = "depth_shadow_map"
    resolution: Literal[512, 1024, 2048] = param(
        512, label="Resolution", help="Texels a side of the map.", unit="px", cost="host"
    )
    threshold: float = param(
        0.3,
        label="Opacity threshold",
        help="Opacity from which a voxel casts a shadow.",
        unit="ratio",
        cost="host",
        ge=0.01,
        le=0.99,
        source="Cohen 2004, section 5.1",
    )
    bias: float = param(
        0.75, label="Bias", help="How far behind the first voxel light still counts as arriving.", unit="m", ge=0, le=10
    )
    strength: float = param(1.0, label="Strength", help="Share of the shadow.", unit="ratio", ge=0, le=1)

    def sun_pass(self, state: ForestState, baked: Mapping[str, Arrays], size: tuple[int, int]) -> SunPass | None:
        """The depth pass over the window that holds what the camera sees."""
        sun = direction(state.sun)
        points = visible_points(state.camera, baked["terrain"], CELL, CANOPY_HEIGHT, REACH, size)
        view = fit(points, sun, baked["terrain"], CELL, CANOPY_HEIGHT)
        uniforms: dict[str, Any] = {
            "shadow_corner": tuple(view.corner),
            "shadow_right": tuple(view.right),
            "shadow_up": tuple(view.up),
            "shadow_threshold": self.threshold,
        }
        declarations = (*self.extra_declarations, "uniform float shadow_threshold;", "uniform float shadow_resolution;")
        uniforms["shadow_resolution"] = float(self.resolution)
        return SunPass("depth", "forest/shadow/depth_shadow_map_depth.glsl", declarations, self.resolution, uniforms)
