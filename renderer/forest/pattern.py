"""Bakes the pattern: every tile of the forest as one atlas of voxels, made from tree geometry."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.forest.ambient import sky_share
from renderer.forest.nursery import bands_of, nursery
from renderer.forest.pattern_kernels import extend, lay
from renderer.forest.pattern_mips import encode_colour, encode_normal, mips
from renderer.forest.planting import NEARNESS, Standing, banded, plant
from renderer.forest.safe_distance import safe_distance
from renderer.forest.seen_levels import OPAQUE, seen_levels
from renderer.forest.species_alone import of_owner, sections
from renderer.forest.tiles import RHOMBI, lattice, tile_table
from renderer.forest.world_scale import CANOPY_HEIGHT, TILE_SIDE, VOXEL
from renderer.world.tree import Tree
from renderer.world.voxelise import Grid, Voxels, opacity_of, voxelise

CELL = round(TILE_SIDE / VOXEL)
"""Voxels a side of a rhombus."""

SIZE = RHOMBI * CELL
"""Voxels a side of the atlas."""

LAYERS = round(CANOPY_HEIGHT / VOXEL)
"""Voxels from the ground to the top of the canopy."""

AXES = lattice(VOXEL)
"""Sides of a voxel [m] along u and v; the third is VOXEL upwards."""

WOOD = 128
"""Mark of trunk and branch in the byte that holds a tree's rank."""


@dataclass(frozen=True)
class Atlas:
    """Sums over everything laid into the atlas so far, indexed [k, j, i]; see `Voxels` for the units."""

    mask: np.ndarray
    normal: np.ndarray
    sums: np.ndarray
    area: np.ndarray
    most: np.ndarray
    anchor: np.ndarray

    @staticmethod
    def empty() -> Atlas:
        """An atlas of air; air belongs to a foot straight below it."""
        shape = (LAYERS, SIZE, SIZE)
        anchor = np.zeros((*shape, 4), np.uint8)
        anchor[..., :2] = 128
        return Atlas(
            np.zeros((3, *shape), np.uint16),
            np.zeros((*shape, 3), np.float32),
            np.zeros((*shape, 4), np.float32),
            np.zeros(shape, np.float32),
            np.zeros(shape, np.float32),
            anchor,
        )

    def add(self, standing: Standing, corner: np.ndarray, found: Voxels) -> None:
        """Lay one voxelised tree into every rhombus where it stands."""
        lay(
            found.mask,
            found.area,
            found.normal,
            found.attributes,
            corner,
            standing.foot,
            standing.rank,
            AXES,
            np.ascontiguousarray(standing.cells * CELL),
            self.mask,
            self.normal,
            self.sums,
            self.area,
            self.most,
            self.anchor,
        )


def voxels_of(tree: Tree, attributes: np.ndarray, standing: Standing) -> tuple[np.ndarray, Voxels]:
    """One tree as voxels, in the frame of its rhombus, so that all its copies are the same to the bit.

    Args:
        tree: the mesh. attributes: (F, 4) linear albedo and wood of its faces. standing: its place.

    Returns:
        Voxel (i, j) of the block's corner, from that of the rhombus, and the block.
    """
    sides = np.zeros((3, 3))
    sides[:2, :2], sides[2, 2] = AXES, VOXEL
    to_index = np.linalg.inv(AXES)
    middle, half = standing.foot @ to_index, standing.reach * np.linalg.norm(to_index, axis=0) + 0.5
    low, high = np.floor(middle - half).astype(int), np.ceil(middle + half).astype(int)
    layers = min(LAYERS, int(standing.scale * tree.height / VOXEL) + 1)
    grid = Grid(np.append(low, 0) @ sides, sides, (int(high[0] - low[0]), int(high[1] - low[1]), layers))
    return low, voxelise(
        tree.placed(standing.scale, standing.girth, standing.azimuth, standing.foot), tree.faces, attributes, grid
    )


def bake_pattern(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """Make the atlas of all tiles.

    Args:
        arguments: the document's `canopy`: weights of the species by name, `mesh`, `density`, `seed`; `apart` for a
        species map: the species stand nearer to each other, each with a band of the ranks (`planting.banded`).
        inputs: none. progress: told the share done; may raise `Cancelled`.

    Returns:
        `colour` uint8 [k, j, i, 4]: linear albedo times opacity, and the opacity over one voxel's length;
        `normal` uint8 [.., 4]: mean of the normals in world axes (0.5 n + 0.5), as short as they disagree, and the
        share of the sky's light;
        `anchor` uint8 [.., 4]: offset east and north to the tree's foot, 128 + 16 a metre; safe distance in voxels
        (Chebyshev distance to matter); the tree's rank (`planting.ranked`), plus WOOD in wood;
        the same with `_1` to `_5` at coarser levels (opacity over the level's own voxel length); `seen_1` to `seen_5`
        as in `seen_levels`; `tile` uint8 [is_down, variant, key, 2]: see `tiles`; `trees` float32 [n, 6]: foot
        x and y in the atlas [m, world axes], height and crown radius [m], number of the species, number of the mesh;
        with `apart`, `bands` (S,), and `seen_1` to `seen_5` of each of the 1 + S `species_alone.sections`, one above
        the other.
    """
    progress(0.0, "growing trees")
    meshes, weights, kinds = nursery(arguments)
    bands = bands_of(kinds, arguments) if arguments.get("apart") else None
    nearness = 1.0 if bands is None else NEARNESS
    standing = plant(meshes, kinds, weights, float(arguments["density"]), int(arguments["seed"]), nearness)
    if bands is not None:
        standing = banded(standing, bands)
    attributes = [np.concatenate([tree.colour, tree.wood[:, None]], axis=1).astype(np.float32) for tree in meshes]
    atlas = Atlas.empty()
    with ThreadPoolExecutor(2) as pool:
        for first in range(0, len(standing), 16):
            progress(0.05 + 0.5 * first / len(standing), "turning trees into voxels")
            some = standing[first : first + 16]
            blocks = pool.map(lambda one: voxels_of(meshes[one.tree], attributes[one.tree], one), some)
            for one, (corner, found) in zip(some, blocks, strict=True):
                atlas.add(one, corner, found)
    planted = None if bands is None else np.unique(bands).astype(np.uint8)
    level = _level(atlas, planted, progress)
    progress(0.9, "making coarser levels")
    result = dict(level)
    for number, coarse in enumerate(mips(level), start=1):
        result |= {f"{name}_{number}": array for name, array in coarse.items()}
    if planted is not None:
        result["bands"] = planted
    result |= _seen(level, planted, lambda share: progress(0.92 + 0.08 * share, "making coarser levels"))
    return {**result, "tile": tile_table(), "trees": _list(standing, meshes, kinds)}


def _seen(level: Arrays, bands: np.ndarray | None, tell: Callable[[float], None]) -> dict[str, np.ndarray]:
    """The coarser levels of what a view ray reads, of each section by itself."""
    if bands is None:
        return seen_levels(level, AXES, VOXEL, tell)
    masks = sections(level["anchor"], bands)
    made = []
    for number, stand in enumerate(masks):
        colour, anchor = np.where(stand[..., None], level["colour"], np.uint8(0)), level["anchor"].copy()
        full = colour[..., 3] > 0
        # What stood there points to trees that do not stand: the air around others has to point to these.
        extend(full, np.zeros((*full.shape, 3), np.float32), anchor, AXES)
        anchor[..., 2] = safe_distance(full)
        own = {"colour": colour, "anchor": anchor}
        made.append(seen_levels(own, AXES, VOXEL, lambda share, n=number: tell((n + share) / len(masks))))  # type: ignore[misc]
    return {name: np.concatenate([one[name] for one in made]) for name in made[0]}


def _level(atlas: Atlas, bands: np.ndarray | None, progress: Callable[[float, str], None]) -> dict[str, np.ndarray]:
    """The finest level's bytes."""
    opacity = opacity_of(atlas.mask)
    area = np.maximum(atlas.area, np.float32(1e-12))[..., None]
    colour = np.concatenate([atlas.sums[..., :3] / area * opacity[..., None], opacity[..., None]], axis=-1)
    encoded = encode_colour(colour)
    # What is stored is what counts: air is where the byte says so.
    full = encoded[..., 3] > 0
    normal = np.zeros((*opacity.shape, 3), np.float32)
    normal[full] = (atlas.normal / area)[full]
    atlas.anchor[..., 3] |= np.where(full & (atlas.sums[..., 3] > 0.5 * atlas.area), WOOD, 0).astype(np.uint8)
    extend(full, normal, atlas.anchor, AXES)
    progress(0.6, "measuring safe distances")
    atlas.anchor[..., 2] = safe_distance(full)
    extinction = -np.log1p(-np.minimum(encoded[..., 3].astype(np.float32) / np.float32(255), OPAQUE)) / np.float32(
        VOXEL
    )
    sky = of_owner(
        atlas.anchor,
        bands,
        lambda own, tell: sky_share(extinction * own, AXES, VOXEL, tell),
        lambda share: progress(0.68 + 0.2 * share, "gathering light from the sky"),
    )
    return {
        "colour": encoded,
        "normal": encode_normal(np.concatenate([normal, sky[..., None]], axis=-1)),
        "anchor": atlas.anchor,
    }


def _list(standing: Sequence[Standing], meshes: Sequence[Tree], kinds: Sequence[int]) -> np.ndarray:
    base = lattice(TILE_SIDE)
    rows = [
        (*(tree.foot + cell @ base), tree.scale * meshes[tree.tree].height, tree.spread, kinds[tree.tree], tree.tree)
        for tree in standing
        for cell in tree.cells
    ]
    return np.array(rows, np.float32)


def tallest(colour: np.ndarray) -> float:
    """Height [m] over the ground that no matter of the pattern passes, with half a voxel for its filtering."""
    filled = np.flatnonzero(colour[..., 3].any(axis=(1, 2)))
    return float(min((filled[-1] + 1.5) / len(colour), 1.0)) * CANOPY_HEIGHT if len(filled) else VOXEL
