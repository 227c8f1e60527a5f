"""Depth shadow map of the canopy (Williams 1978; Cohen 2004, section 5.1)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, Literal

from renderer.core.params import param
from renderer.core.technique import Arrays
from renderer.forest.sun_map import LIGHT_DECLARATIONS, PASS_DECLARATIONS, SunMap
from renderer.forest.sun_view import fit, snapped
from renderer.forest.technique import SunPass
from renderer.forest.world_scale import CANOPY_HEIGHT

if TYPE_CHECKING:
    from renderer.forest.state import ForestState

WINDOW = ("uniform vec4 shadow_window; // m, low corner and sides of a texel",)


class DepthShadowMap(SunMap):
    """The first matter that the sun meets, over what the camera sees, in one map."""

    title: ClassVar[str] = "Depth shadow map"
    caption: ClassVar[str] = (
        "First thing the sun sees, per texel: crisp in a still picture, restless when the sun moves."
    )
    paper: ClassVar[str] = "Williams 1978; Cohen 2004, section 5.1"
    extra_declarations: ClassVar[tuple[str, ...]] = (*LIGHT_DECLARATIONS, *WINDOW)

    kind: Literal["depth_shadow_map"] = "depth_shadow_map"
    resolution: Literal[512, 1024, 2048, 4096] = param(
        512, label="Resolution", help="Texels a side of the map.", unit="px", cost="host"
    )
    snapping: bool = param(
        False,
        label="Snap to texels",
        help="Keep the texels on a grid fixed in the world, so that they stand still while the camera moves.",
        cost="host",
        source="Valient 2007",
    )
    filtered: bool = param(
        False,
        label="Filter",
        help="Blend the comparisons with the four nearest texels.",
        cost="build",
        source="Reeves, Salesin & Cook 1987",
    )

    def sun_pass(self, state: ForestState, baked: Mapping[str, Arrays], size: tuple[int, int]) -> SunPass | None:
        """The depth pass over the window that holds what the camera sees."""
        light = self.light(state, baked)
        window = fit(self.seen(state, baked, size), light, CANOPY_HEIGHT / 2)
        if self.snapping:
            window = snapped(window, self.resolution)
        uniforms = {**self.light_uniforms(light), "shadow_window": window.texels(self.resolution)}
        declarations = (*self.extra_declarations, *PASS_DECLARATIONS)
        return SunPass("depth", "forest/shadow/depth_shadow_map_depth.glsl", declarations, self.resolution, uniforms)
