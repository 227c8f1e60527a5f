"""The 3D texture as the GPU reads it: what is interpolated, and its coarser levels."""

from __future__ import annotations

from dataclasses import dataclass

import moderngl
import numpy as np

from renderer.gl.context import GL
from renderer.gl.textures import Filter
from renderer.shells.levels import Level, pyramid
from renderer.shells.texture.block import ShellTexture
from renderer.shells.voxels import Voxels

TYPES = {"half": np.float16, "float": np.float32}


@dataclass(frozen=True)
class Uploaded:
    """A texture on the GPU, and what its numbers stand for.

    Attributes:
        matter, normal: as shaders/shells/matter.glsl reads them.
        scale: what 1 in them stands for, 1/m. levels: coarser ones.
    """

    matter: moderngl.Texture3D
    normal: moderngl.Texture3D
    scale: float
    levels: int

    def release(self) -> None:
        """Free them."""
        self.matter.release()
        self.normal.release()


def upload(gl: GL, texture: ShellTexture, voxels: Voxels, thickness: float, coarser: bool) -> Uploaded:
    """The texture, in the form that its interpolation asks for.

    Args:
        texture: as it is at the moment. thickness: of the shell [m]. coarser: whether its levels are read.
    """
    finest = Level(texture.extinction(), texture.colour[..., :3], texture.normal)
    levels = [finest]
    if coarser and voxels.interpolation != "nearest":
        levels += pyramid(finest, thickness / finest.extinction.shape[0])
    straight = voxels.interpolation == "straight"
    scale = 1 / texture.reference_length if straight else float(finest.extinction.max()) or 1.0
    matter, normal = zip(*(_read(level, scale, straight) for level in levels), strict=True)
    side = voxels.wrap
    made = [
        gl.texture3d(arrays[0], _between(voxels), (side, side, "clamp"), arrays[1:])
        for arrays in ([array.astype(TYPES[voxels.storage]) for array in part] for part in (matter, normal))
    ]
    return Uploaded(made[0], made[1], scale, len(levels) - 1)


def _between(voxels: Voxels) -> Filter:
    return "nearest" if voxels.interpolation == "nearest" else "linear"


def _read(level: Level, scale: float, straight: bool) -> tuple[np.ndarray, np.ndarray]:
    """What is interpolated: colour and alpha of a reference length 1 / scale, or shares of an extinction `scale`."""
    share = (level.extinction / scale)[..., None]
    if straight:
        return np.concatenate([level.colour, -np.expm1(-share)], axis=-1), level.normal
    return np.concatenate([level.colour * share, share], axis=-1), level.normal * share
