"""The 3D texture as the GPU reads it: what is interpolated, and its coarser levels."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import moderngl
import numpy as np

from renderer.core.technique import Arrays
from renderer.gl.context import GL
from renderer.gl.textures import Filter
from renderer.shells.texture.block import ShellTexture
from renderer.shells.texture.directional import directional_pyramid
from renderer.shells.texture.extinction import Extinct, bytes_of, form_of, halves
from renderer.shells.texture.pyramid import Extents, above_pyramid, extents, mean_pyramid, thesis_pyramid
from renderer.shells.texture.strides import coded
from renderer.shells.voxels import Voxels

PYRAMIDS: dict[str, Callable[[Extinct, Extents], list[Extinct]]] = {
    "thesis": thesis_pyramid,
    "above": above_pyramid,
    "mean": lambda finest, voxel: mean_pyramid(finest),
}
"""How coarser levels are made, by the word of the technique `mipmap`."""


THIN = 0.1
"""Opacity of a reference length below which bytes would err by more than a hundredth of what is seen."""


@dataclass(frozen=True)
class Uploaded:
    """A texture on the GPU, and what its numbers stand for.

    Attributes:
        matter, normal: as shaders/shells/matter.glsl reads them. beside: extinctions along u and v, in the same unit as
            those of `matter`, where the filter tells directions apart.
        coded: as renderer/shells/texture/strides.py tells, where it is asked for.
        scale: what 1 in them stands for, 1/m. levels: coarser ones.
        coding: of normals, factor and summand that make them of what is read.
    """

    matter: moderngl.Texture3D
    normal: moderngl.Texture3D
    beside: moderngl.Texture3D | None
    coded: moderngl.Texture3D | None
    scale: float
    levels: int
    coding: tuple[float, float]

    def release(self) -> None:
        """Free them."""
        self.matter.release()
        self.normal.release()
        if self.beside is not None:
            self.beside.release()
        if self.coded is not None:
            self.coded.release()


def upload(
    gl: GL, texture: ShellTexture, voxels: Voxels, thickness: float, levels: str, sides: tuple[float, float] = (0, 0),
    strides: Arrays | None = None,
) -> Uploaded:
    """The texture, in the form that its interpolation asks for.

    Args:
        texture: as it is at the moment. thickness: of the shell [m]. levels: how coarser ones are made, a key of
            `PYRAMIDS`; empty where none is read. sides: of a voxel along u and v [m], for `directional`.
            strides: of the baked texture, where they are wanted.
    """
    finest = form_of(texture)
    height = thickness / len(finest.matter) / texture.reference_length
    made, beside = [finest], [finest.matter[..., [3, 3]]] if levels == "directional" else []
    if levels and voxels.interpolation != "nearest":
        if levels == "directional":
            u, v = (one / texture.reference_length for one in sides)
            both = directional_pyramid(finest, (u, v, height))
            made, beside = [one.level for one in both], [one.beside for one in both]
        else:
            made = PYRAMIDS[levels](finest, extents(finest.matter.shape, texture.size, height))
    greatest = float(finest.matter[..., 3].max()) or 1.0
    if voxels.interpolation == "straight":
        greatest = 1.0
        parts = [(texture.colour, texture.normal)]
        for level in made[1:]:
            parts.append(_straight(level, *parts[-1]))
        beside = [-np.expm1(-one) for one in beside]
    else:
        parts = [(level.matter, level.surface) for level in made]
    kind = storage_of(voxels, float(texture.colour[..., :3].max()), float(texture.colour[..., 3].max()))
    stored = [[_stored(part[which], 1 / greatest, kind, which == 1) for part in parts] for which in range(2)]
    side = voxels.wrap
    if beside:
        stored.append([_stored(part, 1 / greatest, kind, False) for part in beside])
    matter, normal, *rest = (
        gl.texture3d(part[0], _between(voxels), (side, side, "clamp"), part[1:]) for part in stored
    )
    bytewise = None
    if strides is not None:
        codes = coded(strides, [part[0][..., 3] / np.float32(greatest) for part in parts])
        bytewise = gl.texture3d(codes[0], _between(voxels), (side, side, "clamp"), codes[1:])
        if codes[1:] and voxels.interpolation != "nearest":
            bytewise.filter = moderngl.LINEAR_MIPMAP_NEAREST, moderngl.LINEAR  # levels are whole ones
    coding = (255 / 127, -128 / 127) if kind == "bytes" else (1.0, 0.0)
    scale = greatest / texture.reference_length
    return Uploaded(matter, normal, rest[0] if rest else None, bytewise, scale, len(made) - 1, coding)


def _between(voxels: Voxels) -> Filter:
    return "nearest" if voxels.interpolation == "nearest" else "linear"


def storage_of(voxels: Voxels, brightest: float, densest: float) -> str:
    """How numbers are kept: `bytes`, `half` or `float`.

    Bytes are read three times as fast where the CPU draws, and hold colour and alpha, but neither an extinction, which
    may be a thousandth of another, nor colours above 1, nor opacities that are all of a few steps.

    Args:
        brightest: component of the texture's colours. densest: of its opacities.
    """
    if voxels.storage != "auto":
        return voxels.storage
    return "bytes" if voxels.interpolation == "straight" and brightest <= 1 and densest >= THIN else "half"


def _stored(array: np.ndarray, factor: float, storage: str, signed: bool) -> np.ndarray:
    """An array times a factor in the type that is kept on the GPU."""
    if storage == "bytes":
        return bytes_of(array if factor == 1 else array * np.float32(factor), signed)
    return halves(array, factor) if storage == "half" else array * np.float32(factor)


def _straight(level: Extinct, finer: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Colour and alpha of a reference length, and normal and glow, of a level.

    Args:
        finer, faces: the same of the level before, whose colours and normals stand where there is nothing: what is
            interpolated between matter and nothing must neither darken nor lose the side that it shows to the light.
    """
    extinction = level.matter[..., 3:]
    there = np.broadcast_to(extinction > 0, level.matter.shape)
    colour = np.divide(level.matter, extinction, out=_halved(finer), where=there)
    surface = np.divide(level.surface, extinction, out=_halved(faces), where=there)
    colour[..., 3:] = -np.expm1(-extinction)
    return colour, surface


def _halved(array: np.ndarray) -> np.ndarray:
    """Mean of neighbours (K, J, I, 4) along the first three axes; a last one without a neighbour is left out."""
    for axis in range(3):
        count = array.shape[axis]
        if count > 1:
            before = (slice(None),) * axis
            even, odd = (array[(*before, slice(slot, count // 2 * 2, 2))] for slot in range(2))
            array = (even + odd) * np.float32(0.5)
    return np.ascontiguousarray(array)
