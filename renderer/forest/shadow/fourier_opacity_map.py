"""Fourier opacity map of the canopy (Jansen & Bavoil 2010): how light dies along the sun's way, as a short series."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays
from renderer.forest.land_shadow import shadow_height
from renderer.forest.sun_map import AWAY, LIGHT_DECLARATIONS, SunView
from renderer.forest.sun_view import fit, snapped
from renderer.forest.technique import SunPass
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL
from renderer.world.sun import angles

if TYPE_CHECKING:
    from renderer.forest.state import ForestState

PASS = (
    AWAY,
    "uniform float shadow_level; // added to the mip level of a texel's width",
)


class FourierOpacityMap(SunView):
    """Extinction along the sun's way through the canopy, in every texel a Fourier series over the canopy's crossing."""

    title: ClassVar[str] = "Fourier opacity map"
    caption: ClassVar[str] = "Keeps how the light dies on its way through the leaves, as a few waves per texel."
    paper: ClassVar[str] = "Jansen & Bavoil 2010; Kim & Neumann 2001 (opacity maps)"
    textures: ClassVar[Mapping[str, str]] = {
        "span": "sampler2D",
        "waves_0": "sampler2D",
        "waves_1": "sampler2D",
        "waves_2": "sampler2D",
        "waves_3": "sampler2D",
        "land": "sampler2D",
    }
    extra_declarations: ClassVar[tuple[str, ...]] = (
        *LIGHT_DECLARATIONS,
        "uniform vec4 shadow_window; // m, low corner and sides of a texel",
    )

    kind: Literal["fourier_opacity_map"] = "fourier_opacity_map"
    resolution: Literal[128, 256, 384, 512, 1024, 2048] = param(
        384, label="Resolution", help="Texels a side of the map.", unit="px", cost="host"
    )
    coefficients: Literal[3, 5, 7, 9, 11, 13, 15] = param(
        15,
        label="Coefficients",
        help="Values kept a texel: the mean, and a pair for each wave along the canopy's crossing.",
        cost="build",
        source="Jansen & Bavoil 2010, section 3",
    )
    level: float = param(
        0.5,
        label="Level bias",
        help="Added to the mip level whose voxels are as wide as a texel; negative is sharper.",
        cost="host",
        ge=-3,
        le=2,
        step=0.25,
    )
    damping: float = param(
        0.0,
        label="Damping",
        help="How much the short waves are weakened: less ringing, softer edges.",
        unit="ratio",
        ge=0,
        le=2,
        source="Jansen & Bavoil 2010, section 3",
    )
    snapping: bool = param(
        True,
        label="Snap to texels",
        help="Keep the texels on a grid fixed in the world, so that they stand still while the camera moves.",
        cost="host",
        source="Valient 2007",
    )
    strength: float = param(1.0, label="Strength", help="Share of the canopy's shadow.", unit="ratio", ge=0, le=1)

    def frame_key(self, state: ForestState) -> tuple[Any, ...]:
        """The sun for which the land's shadow is swept."""
        return ("bare land", *(round(angle, 7) for angle in angles(state.sun)))

    def frame_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Height [m] of the shadow of the land without its stands, (N, N): the series has the stands."""
        return {"land": shadow_height(baked["terrain"]["elevation"], CELL, *angles(state.sun))[::-1].copy()}

    def sun_pass(self, state: ForestState, baked: Mapping[str, Arrays], size: tuple[int, int]) -> SunPass | None:
        """The pass that gathers the series over the window that holds what the camera sees."""
        light = self.light(state, baked)
        window = fit(self.seen(state, baked, size), light, CANOPY_HEIGHT / 2)
        if self.snapping:
            window = snapped(window, self.resolution)
        uniforms = {
            **self.light_uniforms(light),
            "shadow_level": self.level,
            "shadow_window": window.texels(self.resolution),
        }
        count = f"#define SHADOW_COEFFICIENTS {self.coefficients}"
        waves = {f"waves_{n}": (4, "f2") for n in range(-(-self.coefficients // 4))}
        return SunPass(
            "waves",
            "forest/shadow/fourier_opacity_map_waves.glsl",
            (count, *self.extra_declarations, *PASS),
            self.resolution,
            uniforms,
            targets={"span": (4, "f4"), **waves},
        )
