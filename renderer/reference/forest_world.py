"""The forest as plain arrays, and what the reference derives from them to march it without looking where nothing is."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from renderer.core.errors import InputError
from renderer.reference.forest_sky_table import level_irradiance, sky_table

Floats = NDArray[np.float64]
Bytes = NDArray[np.uint8]
Colour3 = tuple[float, float, float]

BLOCK = 8
"""Terrain cells along the side of a block whose greatest height lets a ray skip it: about the square root of a default
ray's 64 cells a block row, so that walking blocks and walking cells cost the same."""

TILES = 4
"""Rhombi along each side of the atlas: 4 x 4 x 2 triangles hold the 16 edge triples in two variants each."""

ANCHOR_STEPS = 16.0
"""Steps of a stored anchor offset per metre, from 128 = no offset."""

RANKS = 128
"""Steps in which a stand is thinned: the lowest seven bits of an anchor's last byte are its tree's rank."""

BANDS = 4
"""Species that a species map tells apart: each has as many of the ranks."""

REACH = 127 / ANCHOR_STEPS
"""Longest stored offset from a voxel to its tree's foot along one axis, m."""


@dataclass(frozen=True)
class ForestWorld:
    """One forest, lit by one sun. Axes: x east, y north, z up; metres; linear colours.

    Attributes:
        elevation: (N, N) ground height at the nodes, row 0 = northern edge, the square centred on the origin; bilinear
            between nodes, continued by its edge's value.
        cover: (N, N) cover on the same nodes, 0..1: the ground is wooded where it exceeds 0.5.
        presence: (P, P) share of the trees that stand, 0..1, at the middles of P x P equal parts of the nodes' square
            (side N cells), bilinear between them: a tree stands where it exceeds its rank over RANKS at its foot;
            `cover` where it is left out.
        species: (Q, Q) uint8, the number of the one species that stands there, from 1, or 0 where all do, constant over
            Q x Q equal parts of the same square. With it, a tree's rank counts within the RANKS / BANDS of its species,
            species 1's being the first; without it, all are one.
        growth: (N, N) height of the layer against `canopy_height` on the nodes, bilinear; 1 where it is left out.
        cell: distance between nodes, m.
        canopy_height, tile_side, voxel: height of the layer, side of the tiling's triangles, length for which alpha is
            meant, m.
        colour: (K, J, I, 4) uint8: albedo x opacity, opacity. Layer 0 lies on the ground, I runs along the first edge
            direction and J along the second.
        normal: (K, J, I, 4) uint8: mean normal / 2 + 1/2, shorter where leaves disagree, and the sky's share.
        anchor: (K, J, I, 4) uint8: offset to the tree's foot (from 128, sixteenths of a metre) in the first two; the
            last is above 127 in wood.
        tile: (2, 2, 8, 2) atlas rhombus [down, variant, bottom + 2 left + 4 diagonal].
        seed: of the tiling's hash.
        tint_strength: of the colour change from tree to tree.
        ground_albedo: linear reflectance of bare ground.
        patches: how much the ground's brightness varies from place to place.
        e_sun: irradiance on a plane facing the sun, W m-2, by channel.
        e_sky: irradiance of the sky on the horizontal.
        sun: unit vector to the sun.
        reach: distance along a ray beyond which nothing is met, m: the ground continues without end, and a ray that
            skims it must be let go.
        fade: distance from the square over which what lies beyond it fades from view, m: exp(-(distance / fade)^2).
        leaf_transmission: transmittance of the leaves over their reflectance, by channel; wood has none.
        sky: (E, A, 3) radiance of the sky, W m-2 sr-1: rows of equal steps in the sine of the elevation from the
            horizon up, columns of equal steps in azimuth clockwise from north, even within each; None is even all over.
        background: radiance behind everything for directions (M, 3) -> (M, 3); None leaves it empty (alpha < 1).
    """

    elevation: NDArray[np.floating]
    cover: NDArray[np.floating]
    cell: float
    canopy_height: float
    tile_side: float
    voxel: float
    colour: Bytes
    normal: Bytes
    anchor: Bytes
    tile: Bytes
    seed: int
    tint_strength: float
    ground_albedo: Colour3
    e_sun: Colour3
    e_sky: Colour3
    sun: Colour3
    reach: float = 5e4
    fade: float = math.inf
    background: Callable[[Floats], Floats] | None = None
    patches: float = 0.0
    presence: NDArray[np.floating] | None = None
    species: Bytes | None = None
    growth: NDArray[np.floating] | None = None
    leaf_transmission: Colour3 = (0.0, 0.0, 0.0)
    sky: NDArray[np.floating] | None = None

    def __post_init__(self) -> None:
        """Refuse arrays that do not fit together.

        Raises:
            InputError: naming the wrong one.
        """
        shape = self.elevation.shape
        if self.elevation.ndim != 2 or min(shape) < 2 or shape[0] != shape[1]:
            raise InputError("elevation", f"has shape {shape}", "a square of at least 2 x 2 nodes")
        if self.cover.shape != shape:
            raise InputError("cover", f"has shape {self.cover.shape}", f"{shape} as the elevation")
        if self.presence is not None and (self.presence.ndim != 2 or len(set(self.presence.shape)) > 1):
            raise InputError("presence", f"has shape {self.presence.shape}", "a square")
        if self.species is not None and (self.species.ndim != 2 or len(set(self.species.shape)) > 1):
            raise InputError("species", f"has shape {self.species.shape}", "a square")
        if self.growth is not None and (self.growth.shape != shape or not self.growth.min() > 0):
            raise InputError("growth", f"has shape {self.growth.shape}", f"{shape} as the elevation, above 0")
        atlas = self.colour.shape
        if len(atlas) != 4 or atlas[3] != 4 or atlas[1] != atlas[2] or atlas[2] % TILES:
            raise InputError("colour", f"has shape {atlas}", f"(K, M, M, 4), M a multiple of {TILES}")
        for name in ("colour", "normal", "anchor"):
            if getattr(self, name).shape != atlas or getattr(self, name).dtype != np.uint8:
                raise InputError(name, f"is {getattr(self, name).dtype} {getattr(self, name).shape}", f"uint8 {atlas}")
        if self.tile.shape != (2, 2, 8, 2) or int(self.tile.max()) >= TILES:
            raise InputError("tile", "is no tile table", f"(2, 2, 8, 2), each below {TILES}")
        for name in ("cell", "canopy_height", "tile_side", "voxel", "reach"):
            if not (math.isfinite(getattr(self, name)) and getattr(self, name) > 0):
                raise InputError(name, "must be a positive length")
        if not self.fade > 0:
            raise InputError("fade", "must be a positive length, or infinite")
        if not (np.isfinite(self.elevation).all() and np.isfinite(self.cover).all()):
            raise InputError("elevation", "or cover holds values that are not finite")
        self._check_sky()
        if not math.isclose(sum(c * c for c in self.sun), 1.0, abs_tol=1e-6):
            raise InputError("sun", "must be a unit vector")

    def _check_sky(self) -> None:
        """Refuse a sky that is no table, or whose light is another than the irradiance told beside it."""
        if self.sky is None:
            return
        if self.sky.ndim != 3 or self.sky.shape[2] != 3 or not self.sky.size:
            raise InputError("sky", f"has shape {self.sky.shape}", "(E, A, 3)")
        if not (np.isfinite(self.sky).all() and self.sky.min() >= 0):
            raise InputError("sky", "holds radiance that is negative or not finite")
        if not np.allclose(level_irradiance(np.asarray(self.sky, np.float64)), self.e_sky, rtol=0.02):
            raise InputError("sky", "and e_sky are not the same light")


class Scene(NamedTuple):
    """What the compiled functions read: `ForestWorld` in float64, and the bounds derived from it; `alpha` and `safe` of
    all trees and, under a map of species, of each band of ranks by itself."""

    elevation: Floats
    slope_x: Floats
    slope_y: Floats
    cover: Floats
    share: Floats
    share_cell: float
    species: Bytes
    growth: Floats
    presence: Bytes
    block_top: Floats
    top: float
    layer_top: float
    cell: float
    height: float
    side: float
    voxel: float
    colour: Bytes
    normal: Bytes
    anchor: Bytes
    alpha: Bytes
    safe: Bytes
    tile: Bytes
    seed: int
    tint: float
    patches: float
    ground: Floats
    leaf_transmission: Floats
    e_sun: Floats
    e_sky: Floats
    sky: Floats
    sky_rows: Floats
    sky_columns: Floats
    sky_power: float
    sun: Floats
    reach: float
    fade: float


NOWHERE, EVERYWHERE, SOMEWHERE, ALONE = 0, 1, 2, 3
"""Presence of trees over a cell: no anchor that a voxel there can name is covered, all are, or each must be asked; from
ALONE on, all of one species and no others, species 1's being ALONE."""


def prepare(world: ForestWorld) -> Scene:
    """Derive bounds, slopes and distances from a world."""
    z = np.ascontiguousarray(world.elevation, np.float64)
    cover = np.ascontiguousarray(world.cover, np.float64)
    share = cover if world.presence is None else np.ascontiguousarray(world.presence, np.float64)
    share_cell = float(world.cell * len(z) / len(share))
    growth = np.ones_like(z) if world.growth is None else np.ascontiguousarray(world.growth, np.float64)
    # one-sided differences at the edges, central ones elsewhere; rows run south
    slope_y, slope_x = (np.ascontiguousarray(g) for g in np.gradient(z, world.cell))
    even = np.broadcast_to(np.array(world.e_sky) / math.pi, (1, 1, 3))
    sky = np.require(even if world.sky is None else world.sky, np.float64, ["C", "W"])  # a read-only type compiles anew
    sky_rows, sky_columns, sky_power = sky_table(sky)
    alpha = _alphas(world)
    return Scene(
        elevation=z, slope_x=slope_x, slope_y=-slope_y, cover=cover, share=share, share_cell=share_cell,
        species=np.zeros((0, 0), np.uint8) if world.species is None else np.ascontiguousarray(world.species),
        growth=growth, block_top=_block_top(z),
        presence=_presence(share, share_cell, len(z) - 1, world.cell, world.species),
        top=float(z.max()), layer_top=float(world.canopy_height * growth.max()), cell=float(world.cell),
        height=float(world.canopy_height),
        side=float(world.tile_side), voxel=float(world.voxel), colour=np.ascontiguousarray(world.colour),
        normal=np.ascontiguousarray(world.normal), anchor=np.ascontiguousarray(world.anchor),
        alpha=alpha, safe=np.stack([_safe(each) for each in alpha]),
        tile=np.ascontiguousarray(world.tile, np.uint8), seed=int(world.seed),
        tint=float(world.tint_strength), patches=float(world.patches), ground=np.array(world.ground_albedo, np.float64),
        leaf_transmission=np.array(world.leaf_transmission, np.float64),
        e_sun=np.array(world.e_sun, np.float64), e_sky=np.array(world.e_sky, np.float64),
        sky=sky, sky_rows=sky_rows, sky_columns=sky_columns, sky_power=sky_power,
        sun=np.array(world.sun, np.float64), reach=float(world.reach), fade=float(world.fade))


def _block_top(z: Floats) -> Floats:
    """Greatest height of each block of cells, its border nodes included: no bilinear value inside exceeds it."""
    count = -(-(z.shape[0] - 1) // BLOCK)
    blocks = np.empty((count, count))
    for row in range(count):
        for column in range(count):
            blocks[row, column] = z[
                row * BLOCK : row * BLOCK + BLOCK + 1, column * BLOCK : column * BLOCK + BLOCK + 1
            ].max()
    return blocks


def _presence(share: Floats, share_cell: float, cells: int, cell: float, species: Bytes | None) -> Bytes:
    """For each cell, whether the trees that may reach into it all stand, none does, or each must be asked.

    A voxel names a foot at most `REACH` away along either axis; the share there lies between the extremes of the places
    around it, because it is bilinear. Under a map of species all of one may stand and no others.
    """
    low, high = _extremes(share, share_cell, cells, cell)
    result = np.where(high <= 0.0, NOWHERE, SOMEWHERE)
    ranks = RANKS if species is None else RANKS // BANDS
    full = low > (ranks - 1) / ranks
    if species is None:
        return np.where(full, EVERYWHERE, result).astype(np.uint8)
    first, last = _extremes(species, share_cell * len(share) / len(species), cells, cell)
    alike = np.where(first == 0, EVERYWHERE, ALONE - 1 + first)
    return np.where(full & (first == last), alike, result).astype(np.uint8)


def _extremes(places: NDArray[Any], place: float, cells: int, cell: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Least and greatest of what lies at P x P places, `place` [m] apart, within reach of each of the cells."""
    size = 2 * math.ceil((REACH + 0.5 * cell) / place + 0.5) + 1
    middle = (np.arange(cells) - 0.5 * (cells - 1)) * cell
    # within half a place of the cell's middle, which the window's own half place allows for
    at = np.clip(np.rint(middle / place + 0.5 * (len(places) - 1)).astype(int), 0, len(places) - 1)
    filters = ndimage.minimum_filter, ndimage.maximum_filter
    low, high = (extreme(places, size, mode="nearest")[np.ix_(at, at)] for extreme in filters)
    return low, high


def _alphas(world: ForestWorld) -> Bytes:
    """Opacity of all trees (1, K, J, I), and of each band of ranks by itself (1 + BANDS, K, J, I) under a map."""
    alpha = world.colour[..., 3]
    if world.species is None:
        return np.ascontiguousarray(alpha[None])
    band = world.anchor[..., 3] % RANKS // (RANKS // BANDS)
    return np.stack([alpha, *(np.where(band == one, alpha, np.uint8(0)) for one in range(BANDS))])


def _safe(alpha: Bytes) -> Bytes:
    """Chessboard distance, in texels, from each interpolation cell of the atlas to the nearest one with any opacity.

    Cell (k, j, i) lies between the texel centres k - 1 and k (clamped) upwards, and i and i + 1 (wrapped) along each
    side: [k + 1, j, i] with k from -1. Distances stop at 255; along the sides the atlas is a torus.
    """
    filled = alpha > 0
    layers = np.concatenate([filled[:1], filled, filled[-1:]])
    either = layers[:-1] | layers[1:]
    either = either | np.roll(either, -1, axis=1)
    either = either | np.roll(either, -1, axis=2)
    if not either.any():
        return np.full(either.shape, 255, np.uint8)
    margin = min(either.shape[1], 64)
    padded = np.pad(~either, ((0, 0), (margin, margin), (margin, margin)), mode="wrap")
    distance = ndimage.distance_transform_cdt(padded, metric="chessboard")
    # beyond the margin the torus comes round again, unseen: no distance may claim to know what is there
    inner = distance[:, margin:-margin, margin:-margin]
    return np.minimum(inner, min(margin, 255)).astype(np.uint8)
