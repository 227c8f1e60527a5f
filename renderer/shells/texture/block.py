"""A block of matter: what every source of 3D texture makes, and what all that draws takes.

Texture space is t = (u, v, w) in [0, 1]^3; arrays are indexed [k = w, j = v, i = u] and voxel i has its centre at
(i + 0.5) / n. w = 0 lies on the base surface, w = 1 on the shell's top. Blocks repeat in u and v.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numba
import numpy as np

from renderer.core.technique import Arrays

CLAMP = np.float32(2.0**-12)
"""Least transmittance of a reference length: opacity 1 becomes an extinction of 8.3 per length."""

SOFT_TIP = np.float32(0.35)
"""Share of a strand's full length over which its growing tip gains its opacity."""


@dataclass(frozen=True)
class Matter:
    """What a source makes.

    Attributes:
        colour: (K, J, I, 4), straight linear reflectance and opacity in [0, 1].
        normal: (K, J, I, 4), unit normal in the frame of a box of sides `size`, or 0 for matter without a surface;
            the fourth is the share of the glow that a voxel sends out.
        material: (K, J, I) uint8: 0 nothing, 1 the first matter, 2 the second, whose opacity can be changed.
        birth: (K, J, I) or None: the growth at which the tip of a strand enters a voxel.
        rank: (K, J, I) or None: the density from which a voxel's strand is there.
        reference_length: path for which the opacity is meant [m]; 0: one voxel of the shell's height.
        size: sides of the box in any one unit; None: its voxels are cubes.
        notes: what was assumed, in words.
    """

    colour: np.ndarray
    normal: np.ndarray
    material: np.ndarray
    birth: np.ndarray | None = None
    rank: np.ndarray | None = None
    reference_length: float = 0.0
    size: tuple[float, float, float] | None = None
    notes: tuple[str, ...] = ()

    def arrays(self) -> dict[str, np.ndarray]:
        """The same as plain arrays, as a bake keeps them: `birth` and `rank` where there are strands, `notes` text."""
        layers, rows, columns = self.material.shape
        size = self.size or (columns / layers, rows / layers, 1.0)
        grown = {"birth": self.birth, "rank": self.rank}
        return {
            "colour": self.colour,
            "normal": self.normal,
            "material": self.material,
            "size": np.array(size),
            "reference_length": np.array(self.reference_length),
            "notes": np.array("; ".join(self.notes)),
            **{name: array for name, array in grown.items() if array is not None},
        }


@dataclass(frozen=True)
class ShellTexture:
    """A 3D texture as it is drawn.

    Attributes:
        colour: (K, J, I, 4) float32, straight linear reflectance and opacity in [0, 1] of `reference_length`.
        normal: (K, J, I, 4) float32, unit normal in the frame of a box of sides `size` or 0, and the share of glow.
        size: sides of the box along u, v, w, in any one unit.
        reference_length: path for which the opacity is meant [m].
    """

    colour: np.ndarray
    normal: np.ndarray
    size: tuple[float, float, float]
    reference_length: float

    def extinction(self) -> np.ndarray:
        """Extinction per metre, (K, J, I) float32."""
        return extinction_of(self.colour[..., 3], self.reference_length)


def extinction_of(opacity: np.ndarray, reference_length: float) -> np.ndarray:
    """-ln(1 - min(opacity, 1 - 2^-12)) / reference length, per metre, float32."""
    solid = np.minimum(opacity.astype(np.float64), 1 - float(CLAMP))
    return (-np.log1p(-solid) / reference_length).astype(np.float32)


def reference_length(baked: Arrays, thickness: float) -> float:
    """Path for which a baked texture's opacity is meant [m], under a shell of a thickness [m]."""
    return float(baked["reference_length"]) or thickness / baked["colour"].shape[0]


def texture_of(
    baked: Arrays, thickness: float, *, growth: float = 1.0, density: float = 1.0, second: float = 1.0
) -> ShellTexture:
    """A baked texture as it is at a moment.

    Args:
        baked: what `bake_texture` gave.
        thickness: of the shell [m].
        growth, density: in [0, 1], of strands; without effect where there are none.
        second: factor in [0, 1] on the opacity of the second material.
    """
    colour = np.asarray(baked["colour"], np.float32)
    opacity = opacity_at(baked, growth=growth, density=density, second=second)
    if opacity is not None:
        colour = np.concatenate([colour[..., :3], opacity[..., None]], axis=-1)
    sides = tuple(float(side) for side in baked["size"])
    return ShellTexture(
        colour, np.asarray(baked["normal"], np.float32), (sides[0], sides[1], sides[2]),
        reference_length(baked, thickness),
    )


def opacity_at(
    baked: Mapping[str, np.ndarray], *, growth: float = 1.0, density: float = 1.0, second: float = 1.0
) -> np.ndarray | None:
    """Opacity (K, J, I) float32 at a moment, or None where it is that of the bake (see `texture_of`).

    A strand's tip is opaque only `SOFT_TIP` behind its front: opacity grows as growth passes `birth`.
    """
    strands = "birth" in baked
    if second == 1.0 and not strands:
        return None
    full = np.ascontiguousarray(baked["colour"][..., 3], np.float32)
    out = np.empty_like(full)
    _opacity(full, baked["material"], *moment_arrays(baked, growth, density, second), out)
    return out


@numba.njit(cache=True, inline="always")
def opacity_then(opacity, material, birth, rank, growth, density, second):
    """Opacity of one voxel at a moment (see `opacity_at`); where there are no strands, `birth` and `rank` are 0 and
    growth and density 1."""
    if material == 2:
        opacity *= second
    if rank >= density:
        return np.float32(0)
    return opacity * min(max((growth - birth) / SOFT_TIP, np.float32(0)), np.float32(1))


def moment_arrays(
    baked: Mapping[str, np.ndarray], growth: float, density: float, second: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Birth and rank (K, J, I) float32 of a bake, and the moment (3,), as compiled loops take them."""
    if "birth" in baked:
        moment = np.array([growth, density, second], np.float32)
        return np.asarray(baked["birth"], np.float32), np.asarray(baked["rank"], np.float32), moment
    nothing = np.broadcast_to(np.float32(0), baked["material"].shape)
    return nothing, nothing, np.array([1.0, 1.0, second], np.float32)


@numba.njit(cache=True, nogil=True)
def _opacity(full, material, birth, rank, moment, out):
    growth, density, second = moment
    layers, rows, columns = full.shape
    for k in range(layers):
        for j in range(rows):
            for i in range(columns):
                out[k, j, i] = opacity_then(
                    full[k, j, i], material[k, j, i], birth[k, j, i], rank[k, j, i], growth, density, second
                )
