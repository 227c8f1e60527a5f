"""Transmittance functions of the voxels: shadow within and between trees in one fetch, whatever the sun."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays, Bake
from renderer.forest.land_shadow import land_shadow
from renderer.forest.technique import ForestTechnique
from renderer.forest.transmittance import at_sun, transmittance_bake
from renderer.world.sun import angles

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


def kept_elevations(elevation: float) -> np.ndarray:
    """The four elevations [rad] that a frame keeps around the sun's own, each the same ratio above the one before.

    Slopes raise and lower the canopy, and at low elevations a degree counts most. As in the GLSL.
    """
    lowest = max(elevation - 0.42, 0.3 * elevation, 0.035)
    return np.geomspace(lowest, max(min(elevation + 0.5, 1.48), 2 * lowest), 4)


class VoxelTransmittance(ForestTechnique):
    """Each voxel knows how much of a sun anywhere in the sky it sees, in a few coefficients; one fetch reads it."""

    title: ClassVar[str] = "Voxel transmittance"
    caption: ClassVar[str] = "Every voxel knows its share of a sun anywhere in the sky: one fetch, soft and steady."
    paper: ClassVar[str] = "Sloan, Hall, Hart & Snyder 2003; Cohen 2004, ch. 1.1"
    textures: ClassVar[Mapping[str, str]] = {"shares": "sampler3D", "land": "sampler2D"}

    kind: Literal["voxel_transmittance"] = "voxel_transmittance"
    coefficients: Literal[4, 8, 16, 32] = param(
        16,
        label="Coefficients",
        help="Kept a voxel: more follow the sun more closely.",
        cost="bake",
        source="Sloan et al. 2003, section 4",
    )
    strength: float = param(1.0, label="Strength", help="Share of the canopy's shadow.", unit="ratio", ge=0, le=1)

    def bakes(self, state: ForestState, terrain: Bake, pattern: Bake) -> list[Bake]:
        """The voxels' functions."""
        return [transmittance_bake(pattern, self.coefficients)]

    def frame_key(self, state: ForestState) -> tuple[Any, ...]:
        """The sun for which the functions are resolved."""
        return (self.kind, self.coefficients, *(round(angle, 7) for angle in angles(state.sun)))

    def frame_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """`shares` (K, J, I, 4) bytes at four elevations over the slope, `land` (N, N) height of the shadow [m]."""
        azimuth, elevation = angles(state.sun)
        return {
            "shares": at_sun(baked["transmittance"], azimuth, kept_elevations(elevation)),
            "land": land_shadow(baked["terrain"], (azimuth, elevation)),
        }
