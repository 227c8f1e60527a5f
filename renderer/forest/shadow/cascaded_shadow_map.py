"""Cascaded shadow maps: one for each slice of the view's depth (Engel 2006; Zhang et al. 2006)."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays
from renderer.forest.sun_map import LIGHT_DECLARATIONS, PASS_DECLARATIONS, SunMap
from renderer.forest.sun_view import PROBES, Window, depths, fit, snapped
from renderer.forest.technique import SunPass
from renderer.forest.world_scale import CANOPY_HEIGHT

if TYPE_CHECKING:
    from renderer.forest.state import ForestState

MOST = 4
"""Cascades at most."""


class CascadedShadowMap(SunMap):
    """Several depth maps, each for one slice of the view's depth, on grids fixed in the world."""

    title: ClassVar[str] = "Cascaded shadow map"
    caption: ClassVar[str] = "Fine texels near, coarse ones far, all on grids that stand still while the camera moves."
    paper: ClassVar[str] = "Engel 2006; Zhang, Sun, Xu & Lun 2006; Valient 2007"
    extra_declarations: ClassVar[tuple[str, ...]] = (
        *LIGHT_DECLARATIONS,
        f"uniform vec4 shadow_windows[{MOST}]; // m, low corner and sides of a texel of each cascade",
    )

    kind: Literal["cascaded_shadow_map"] = "cascaded_shadow_map"
    cascades: Literal[2, 3, 4] = param(3, label="Cascades", help="Slices of the view's depth.", cost="build")
    resolution: Literal[256, 512, 1024, 2048] = param(
        512, label="Resolution", help="Texels a side of each cascade.", unit="px", cost="host"
    )
    split: float = param(
        0.7,
        label="Split",
        help="Between slices of equal depth (0) and slices of equal ratio (1).",
        unit="ratio",
        cost="host",
        ge=0,
        le=1,
        source="Zhang, Sun, Xu & Lun 2006, section 3",
    )
    snapping: bool = param(
        True,
        label="Snap to texels",
        help="Keep the texels on grids fixed in the world, so that they stand still while the camera moves.",
        cost="host",
        source="Valient 2007",
    )
    filtered: bool = param(
        True,
        label="Filter",
        help="Blend the comparisons with the four nearest texels.",
        cost="build",
        source="Reeves, Salesin & Cook 1987",
    )
    fade: float = param(
        1.0,
        label="Fade",
        help="Length over which light is lost behind the first matter; 0 at once.",
        unit="m",
        ge=0,
        le=20,
        source="Dachsbacher & Stamminger 2003",
    )

    def windows(
        self, state: ForestState, baked: Mapping[str, Arrays], size: tuple[int, int]
    ) -> list[tuple[float, float, float, float]]:
        """Corner and texel sides [m] of each cascade, the nearest first, for a picture of `size`."""
        light = self.light(state, baked)
        points = self.seen(state, baked, size)
        depth = depths(state.camera, points)
        found: list[Window] = []
        limits = splits(float(depth.min()), float(depth.max()), self.cascades, self.split)
        for near, far in itertools.pairwise(limits):
            held = points[(depth >= near) & (depth <= far)]
            # Between two of the probing rays the view may reach this much farther.
            margin = CANOPY_HEIGHT / 2 + max(far, 0.0) / PROBES / 2
            window = fit(held if len(held) else points, light, margin)
            found.append(snapped(window, self.resolution) if self.snapping else window)
        texels = [window.texels(self.resolution) for window in found]
        return texels + texels[-1:] * (MOST - len(texels))

    def sun_pass(self, state: ForestState, baked: Mapping[str, Arrays], size: tuple[int, int]) -> SunPass | None:
        """The depth pass over every cascade's window."""
        uniforms = {
            **self.light_uniforms(self.light(state, baked)),
            "shadow_windows": tuple(self.windows(state, baked, size)),
            "shadow_resolution": float(self.resolution),
        }
        declarations = (*self.extra_declarations, *PASS_DECLARATIONS, "uniform float shadow_resolution;")
        glsl = "forest/shadow/cascaded_shadow_map_depth.glsl"
        return SunPass("depth", glsl, declarations, self.resolution, uniforms, layers=self.cascades)


def splits(near: float, far: float, count: int, share: float) -> np.ndarray:
    """Depths (count + 1) [m] at which the slices meet, between equal widths and equal ratios.

    A nearest depth below a hundredth of the farthest, or behind the camera, counts as that.

    Source: Zhang, Sun, Xu & Lun 2006, section 3, C_i = lambda C_log + (1 - lambda) C_uniform.
    """
    low = max(near, 0.01 * abs(far), 1e-3)
    high = max(far, 1.001 * low)
    step = np.arange(count + 1) / count
    found = share * low * (high / low) ** step + (1 - share) * (low + (high - low) * step)
    return np.concatenate([[min(near, low)], found[1:-1], [max(far, high)]])
