"""GPU textures of what the forest baked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import moderngl
import numpy as np
from scipy.ndimage import distance_transform_edt

from renderer.core.technique import Arrays
from renderer.forest.tiles import cell_hash, tile_table
from renderer.forest.world_scale import CELL, PRESENCE_CELL
from renderer.gl.context import GL
from renderer.gl.program import AnyTexture
from renderer.gl.textures import Wrap
from renderer.world.terrain import normals

if TYPE_CHECKING:
    from renderer.forest.technique import ForestTechnique

FILTERED = 6.0
"""Metres by which the distance to the next stand is shortened: a texel's diagonal, over which it is filtered."""

HALF = 32768 / 65535
"""What 16 bits hold for no rise: exactly, so that flat ground is flat."""

TILE_MAP = 256
"""Cells a side of the patch of tiles that is kept: 10 km, twice the square; farther out it comes round again."""

NO_SPECIES = np.zeros((1, 1, 2), np.uint8)
"""The species map of a land without one."""

ATLAS_WRAP: tuple[Wrap, Wrap, Wrap] = ("repeat", "repeat", "clamp")
"""The atlas comes round along its sides, and ends above and below."""


def bilinear_cells(elevation: np.ndarray) -> tuple[np.ndarray, tuple[float, float]]:
    """Coefficients of each cell's bilinear height, (N, N, 4) uint16, row 0 at the south, and their two ranges [m].

    One unfiltered fetch of eight bytes then gives the height, where filtering four heights in hardware costs twice as
    much. The first is a share of the first range, which the whole relief spans; the others, of the second either way
    from 0.5: 16 bits keep a relief of 700 m to 1 cm.
    """
    height = elevation[::-1].astype(np.float64)
    padded = np.pad(height, ((0, 1), (0, 1)), mode="edge")
    here, east, north, both = padded[:-1, :-1], padded[:-1, 1:], padded[1:, :-1], padded[1:, 1:]
    rises = np.stack([east - here, north - here, here - east - north + both], axis=-1)
    relief = max(float(height.max()), 1.0)
    # A little room: half lies above the middle of 16 bits, and the steepest rise must not come round to the
    # deepest fall.
    rise = max(float(np.abs(rises).max()), 1e-3) * 1.0001
    shares = np.concatenate([here[..., None] / relief, rises / (2 * rise) + HALF], axis=-1)
    return np.rint(shares * 65535).astype(np.uint16), (relief, rise)


def stand_texture(presence: np.ndarray) -> np.ndarray:
    """Share of the trees that stand (of 255) and metres to the next one at least, (P, P, 2) uint8, row 0 at the south.

    Filtered between its texels, as the truth is.
    """
    share = presence[::-1]
    some = share > 0
    away = distance_transform_edt(~some) * PRESENCE_CELL - FILTERED if some.any() else np.full(some.shape, 255.0)
    return np.stack([share, np.clip(away, 0, 255)], axis=-1).astype(np.uint8)


def ground_textures(gl: GL, ground: Arrays) -> dict[str, AnyTexture]:
    """`heights`, `normals` (with the smooth cover), `cover`, `species` and `growth` from the `terrain` bake."""
    slope = normals(ground["elevation"], (CELL, CELL))[::-1]
    return {
        "heights": gl.texture2d(bilinear_cells(ground["elevation"])[0], filter="nearest"),
        "normals": gl.texture2d(np.concatenate([slope, ground["cover"][::-1, :, None]], axis=-1).astype(np.float16)),
        "cover": gl.texture2d(stand_texture(ground["presence"])),
        "species": gl.texture2d(_species(ground), filter="nearest"),
        "growth": gl.texture2d(np.ascontiguousarray(ground["growth"][::-1]), filter="linear"),
    }


def _species(ground: Arrays) -> np.ndarray:
    """Number and section of the species that stands at each place, (P, P, 2) uint8, row 0 at the south."""
    if "species" not in ground:
        return NO_SPECIES
    number = ground["species"][::-1]
    return np.stack([number, np.asarray(ground["sections"])[number]], axis=-1)


def packed(colour: np.ndarray, anchor: np.ndarray) -> np.ndarray:
    """Colour and anchor of each voxel as four 16-bit numbers, so that a march reads a voxel from one cache line.

    Two bytes in each: red and green, blue and opacity, foot x and y, distance and wood. The colour is the albedo,
    as coarser levels have it, no longer times the opacity: light may be looked at where another level begins.
    """
    opacity = np.maximum(colour[..., 3:], 1).astype(np.uint16)
    albedo = np.minimum((colour[..., :3].astype(np.uint16) * 255 + opacity // 2) // opacity, 255).astype(np.uint8)
    return paired(np.concatenate([albedo, colour[..., 3:], anchor], axis=-1))


def paired(given: np.ndarray) -> np.ndarray:
    """Two bytes in each 16-bit number, the first the higher."""
    both = given.astype(np.uint16)
    return both[..., 0::2] * np.uint16(256) + both[..., 1::2]


def kept_textures(gl: GL, slot: str, arrays: Mapping[str, Sequence[np.ndarray]]) -> dict[str, AnyTexture]:
    """A technique's unfiltered 3D samplers over the torus of the atlas, from their mip levels, finest first."""
    return {
        f"{slot}_{name}": gl.texture3d(levels[0], "nearest", ATLAS_WRAP, levels[1:]) for name, levels in arrays.items()
    }


def technique_textures(
    gl: GL, slot: str, technique: ForestTechnique, arrays: Mapping[str, np.ndarray]
) -> dict[str, AnyTexture]:
    """A technique's samplers for a moment: filtered, 3D ones over the torus of the atlas; doubles become floats."""
    made: dict[str, AnyTexture] = {}
    for name, given in arrays.items():
        array = given.astype(np.float32) if given.dtype == np.float64 else given
        if technique.textures[name] == "sampler3D":
            made[f"{slot}_{name}"] = gl.texture3d(array, "linear", ATLAS_WRAP)
        else:
            made[f"{slot}_{name}"] = gl.texture2d(array, wrap=technique.wrap.get(name, "clamp"))
    return made


def pattern_textures(gl: GL, pattern: Arrays) -> dict[str, AnyTexture]:
    """`pattern_voxels`, `species_voxels` and `pattern_normal` from the `pattern` bake, with its own mip levels."""
    ends = _endings(pattern)
    seen = [paired(pattern[f"seen{end}"]) for end in ends[1:]]
    # Under a species map coarser levels have sections, which the finest, where each tree is asked, has not.
    coarse, alone = ([], seen) if "bands" in pattern else (seen, [np.zeros((1, 1, 1, 4), np.uint16)])
    normals_of = [pattern[f"normal{end}"] for end in ends]
    shaded = gl.texture3d(normals_of[0], "linear", ATLAS_WRAP, normals_of[1:])
    # The level asked for is always whole: blending two levels would fetch twice for nothing.
    shaded.filter = moderngl.LINEAR_MIPMAP_NEAREST, moderngl.LINEAR
    return {
        "pattern_voxels": gl.texture_array(packed(pattern["colour"], pattern["anchor"]), "nearest", "repeat", coarse),
        "pattern_normal": shaded,
        "species_voxels": gl.texture_array(alone[0], "nearest", "repeat", alone[1:]),
    }


def _endings(pattern: Arrays) -> list[str]:
    return ["", *(f"_{level}" for level in range(1, 16) if f"colour_{level}" in pattern)]


def tile_map(seed: int) -> np.ndarray:
    """Tiles of a patch of the lattice around the origin, (TILE_MAP, TILE_MAP, 2) uint8: upward and downward triangles.

    The tiling needs no storage (`tiles.locate` reaches any point); the shader reads this patch of it because one fetch
    costs less than four hashes. Cell (i, j) is at column i mod TILE_MAP, row j mod TILE_MAP; each value is 4 p + q.
    """
    half = TILE_MAP // 2
    cell = (np.arange(TILE_MAP) + half) % TILE_MAP - half
    j, i = np.meshgrid(cell, cell, indexing="ij")
    table = tile_table()
    maps = []
    for down in (0, 1):
        bottom = cell_hash(i, j + down, 0, seed) & 1
        left = cell_hash(i + down, j, 1, seed) & 1
        diagonal = cell_hash(i, j, 2, seed) & 1
        variant = cell_hash(i, j, 3 + down, seed) & 1
        rhombus = table[down, variant, bottom + 2 * left + 4 * diagonal]
        maps.append(rhombus[..., 0] * 4 + rhombus[..., 1])
    return np.stack(maps, axis=-1).astype(np.uint8)
