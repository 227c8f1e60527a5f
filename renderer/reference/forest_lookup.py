"""What stands at a point of the forest: the tiling's hash, the atlas between its texels, cover and ground, in float64.

Written from the world's definition alone, so that a mistake in the shaders is not repeated here. Tiles: Neyret and Cani
1999; hash: the lowbias32 finaliser (Wellons 2018). All functions are compiled and release the interpreter's lock.
"""

from __future__ import annotations

import math

from numba import njit

from renderer.reference.forest_world import ALONE, ANCHOR_STEPS, BANDS, NOWHERE, RANKS, SOMEWHERE, TILES, Scene

MASK = 0xFFFFFFFF
ALPHA_MAX = 1.0 - 2.0**-12
"""Opacity at which extinction stops growing: 8.3 a voxel, below a thousandth of the light after one voxel."""


@njit(cache=True, nogil=True, inline="always")
def edge_hash(i: int, j: int, d: int, seed: int) -> int:
    """32 bits from a lattice cell, an edge direction (or 3, 4 for the two triangles) and a seed."""
    x = ((i & MASK) * 0x8DA6B343) & MASK
    x ^= ((j & MASK) * 0xD8163841) & MASK
    x ^= (d * 0xCB1AB31F) & MASK
    x ^= ((seed & MASK) * 0x165667B1) & MASK
    x ^= x >> 16
    x = (x * 0x7FEB352D) & MASK
    x ^= x >> 15
    x = (x * 0x846CA68B) & MASK
    return x ^ (x >> 16)


@njit(cache=True, nogil=True)
def rhombus(scene: Scene, i: int, j: int, down: int) -> tuple[int, int]:
    """Atlas rhombus (p, q) of the upward or downward triangle of lattice cell (i, j)."""
    bottom = edge_hash(i, j + down, 0, scene.seed) & 1
    left = edge_hash(i + down, j, 1, scene.seed) & 1
    diagonal = edge_hash(i, j, 2, scene.seed) & 1
    variant = edge_hash(i, j, 3 + down, scene.seed) & 1
    index = bottom + 2 * left + 4 * diagonal
    return int(scene.tile[down, variant, index, 0]), int(scene.tile[down, variant, index, 1])


@njit(cache=True, nogil=True)
def lattice(scene: Scene, x: float, y: float) -> tuple[float, float]:
    """Lattice coordinates: (x, y) = u (a, 0) + v (a/2, a sqrt(3)/2)."""
    v = y / (scene.side * math.sqrt(0.75))
    return x / scene.side - 0.5 * v, v


@njit(cache=True, nogil=True)
def texel(scene: Scene, x: float, y: float) -> tuple[float, float]:
    """Atlas texel coordinates of a place, texel centres at integers."""
    u, v = lattice(scene, x, y)
    i, j = math.floor(u), math.floor(v)
    p, q = rhombus(scene, i, j, 0 if u - i + v - j < 1.0 else 1)
    per = scene.colour.shape[2] / TILES
    return (p + u - i) * per - 0.5, (q + v - j) * per - 0.5


@njit(cache=True, nogil=True)
def bilinear(grid, cell: float, x: float, y: float) -> float:
    """A node grid at a place, continued by its edge's value."""
    last = grid.shape[0] - 1
    column = min(max(x / cell + 0.5 * last, 0.0), float(last))
    row = min(max(0.5 * last - y / cell, 0.0), float(last))
    j, i = min(int(column), last - 1), min(int(row), last - 1)
    u, v = column - j, row - i
    return (grid[i, j] * (1 - u) + grid[i, j + 1] * u) * (1 - v) + (
        grid[i + 1, j] * (1 - u) + grid[i + 1, j + 1] * u
    ) * v


@njit(cache=True, nogil=True)
def ground_normal(scene: Scene, x: float, y: float) -> tuple[float, float, float]:
    """Unit normal of the smooth ground: slopes by central differences at the nodes, bilinear between them."""
    a, b = bilinear(scene.slope_x, scene.cell, x, y), bilinear(scene.slope_y, scene.cell, x, y)
    length = math.sqrt(a * a + b * b + 1.0)
    return -a / length, -b / length, 1.0 / length


@njit(cache=True, nogil=True, inline="always")
def _corners(scene: Scene, tu: float, tv: float, tk: float) -> tuple[int, int, int, int, int, int]:
    """The two texels along each axis around a place, wrapped along the sides and clamped upwards.

    Coordinates come from `texel` or the march, so that a side is left by less than one texel and needs no division.
    """
    size, layers = scene.colour.shape[2], scene.colour.shape[0]
    i, j, k = math.floor(tu), math.floor(tv), math.floor(tk)
    i0, i1 = (i if i >= 0 else i + size), (i + 1 if i + 1 < size else i + 1 - size)
    j0, j1 = (j if j >= 0 else j + size), (j + 1 if j + 1 < size else j + 1 - size)
    return i0, i1, j0, j1, min(max(k, 0), layers - 1), min(max(k + 1, 0), layers - 1)


@njit(cache=True, nogil=True)
def _of_species(scene: Scene, x: float, y: float, i: int, j: int, k: int) -> bool:
    """Whether the tree of texel (i, j, k) stands under a map of species, its foot told from a sample at (x, y).

    Trees of other species stand inside one another's crowns: what is between texels must be asked of each of them.
    """
    foot_x = x + (scene.anchor[k, j, i, 0] - 128.0) / ANCHOR_STEPS
    foot_y = y + (scene.anchor[k, j, i, 1] - 128.0) / ANCHOR_STEPS
    count, each = scene.species.shape[0], RANKS // BANDS
    part = len(scene.elevation) * scene.cell / count
    row = min(max(math.floor(0.5 * count - foot_y / part), 0), count - 1)
    column = min(max(math.floor(foot_x / part + 0.5 * count), 0), count - 1)
    alone, rank = scene.species[row, column], scene.anchor[k, j, i, 3] % RANKS
    if alone != 0 and rank // each != alone - 1:
        return False
    return bilinear(scene.share, scene.share_cell, foot_x, foot_y) > (rank % each) / each


@njit(cache=True, nogil=True)
def alpha_at(scene: Scene, presence: int, x: float, y: float, tu: float, tv: float, tk: float) -> float:
    """Opacity 0..1 of one voxel length, trilinear between texel centres; under a map of species, of what stands."""
    u, v, w = tu - math.floor(tu), tv - math.floor(tv), tk - math.floor(tk)
    i0, i1, j0, j1, k0, k1 = _corners(scene, tu, tv, tk)
    if presence == SOMEWHERE and scene.species.shape[0] > 0:
        total = 0.0
        for corner in range(8):
            i, fu = (i1, u) if corner & 1 else (i0, 1 - u)
            j, fv = (j1, v) if corner & 2 else (j0, 1 - v)
            k, fw = (k1, w) if corner & 4 else (k0, 1 - w)
            if scene.alpha[0, k, j, i] > 0 and _of_species(scene, x, y, i, j, k):
                total += fu * fv * fw * scene.alpha[0, k, j, i]
        return total / 255.0
    c = scene.alpha[plane(presence)]
    low = (c[k0, j0, i0] * (1 - u) + c[k0, j0, i1] * u) * (1 - v)
    low += (c[k0, j1, i0] * (1 - u) + c[k0, j1, i1] * u) * v
    high = (c[k1, j0, i0] * (1 - u) + c[k1, j0, i1] * u) * (1 - v)
    high += (c[k1, j1, i0] * (1 - u) + c[k1, j1, i1] * u) * v
    return (low * (1 - w) + high * w) / 255.0


@njit(cache=True, nogil=True, inline="always")
def plane(presence: int) -> int:
    """Which of the scene's opacities a cell has: of all trees, or of the one species that stands there alone."""
    return max(presence - ALONE + 1, 0)


@njit(cache=True, nogil=True)
def voxel_at(scene: Scene, x: float, y: float, tu: float, tv: float, tk: float, out) -> None:
    """All that the atlas holds at a place, trilinear, 0..1: out[0:4] = `colour`, out[4:8] = `normal`.

    Under a map of species, `colour` is of what stands, seen from a sample at (x, y); the ground has a `normal` anyway.
    """
    u, v, w = tu - math.floor(tu), tv - math.floor(tv), tk - math.floor(tk)
    i0, i1, j0, j1, k0, k1 = _corners(scene, tu, tv, tk)
    out[:8] = 0.0
    for corner in range(8):
        i, fu = (i1, u) if corner & 1 else (i0, 1 - u)
        j, fv = (j1, v) if corner & 2 else (j0, 1 - v)
        k, fw = (k1, w) if corner & 4 else (k0, 1 - w)
        weight = fu * fv * fw / 255.0
        for c in range(4):
            out[4 + c] += weight * scene.normal[k, j, i, c]
        if scene.species.shape[0] == 0 or _of_species(scene, x, y, i, j, k):
            for c in range(4):
                out[c] += weight * scene.colour[k, j, i, c]


@njit(cache=True, nogil=True)
def foot(scene: Scene, x: float, y: float, tu: float, tv: float, tk: float, centred: bool) -> tuple[float, float]:
    """Foot of the tree that owns the nearest voxel.

    The world adds the stored offset to the sample; `centred` adds it to the voxel's centre instead, which gives every
    sample of a tree the same foot, and is what tells trees apart.
    """
    size, layers = scene.anchor.shape[2], scene.anchor.shape[0]
    i, j, k = math.floor(tu + 0.5), math.floor(tv + 0.5), math.floor(tk + 0.5)
    k = min(max(k, 0), layers - 1)
    if centred:
        step = scene.side * TILES / size
        x += ((i - tu) + 0.5 * (j - tv)) * step
        y += math.sqrt(0.75) * (j - tv) * step
    stored_x = scene.anchor[k, j % size, i % size, 0]
    stored_y = scene.anchor[k, j % size, i % size, 1]
    return x + (stored_x - 128.0) / ANCHOR_STEPS, y + (stored_y - 128.0) / ANCHOR_STEPS


@njit(cache=True, nogil=True)
def stands(scene: Scene, presence: int, x: float, y: float, tu: float, tv: float, tk: float) -> bool:
    """Whether the tree that owns a sample exists: the share that stands at its foot exceeds its rank."""
    if presence == NOWHERE:
        return False
    if presence != SOMEWHERE or scene.species.shape[0] > 0:
        return True  # under a map of species each texel was asked: see `alpha_at`
    foot_x, foot_y = foot(scene, x, y, tu, tv, tk, False)
    size, layers = scene.anchor.shape[2], scene.anchor.shape[0]
    k = min(max(math.floor(tk + 0.5), 0), layers - 1)
    rank = scene.anchor[k, math.floor(tv + 0.5) % size, math.floor(tu + 0.5) % size, 3] % RANKS
    return bilinear(scene.share, scene.share_cell, foot_x, foot_y) > rank / RANKS


@njit(cache=True, nogil=True)
def extinction(scene: Scene, alpha: float) -> float:
    """Extinction, 1/m, of an opacity that is meant for one voxel length."""
    return -math.log(1.0 - min(alpha, ALPHA_MAX)) / scene.voxel


@njit(cache=True, nogil=True)
def tint(x: float, y: float) -> float:
    """Smooth value in [-1, 1] that varies from tree to tree, of a foot in metres."""
    return math.sin(x * 0.37 + 1.3 * math.sin(y * 0.11)) * math.sin(y * 0.41 + 1.7 * math.sin(x * 0.13))


COARSE, FINE = 25.0, 10.0
"""Metres between the nodes of the two octaves of the ground's patches."""

COARSE_SHARE = 0.65
"""Weight of the coarse octave."""


@njit(cache=True, nogil=True)
def _node(i: int, j: int, kind: int) -> float:
    """Value in [-1, 1) of a node of the noise: the hash's upper 24 bits."""
    return 2.0 * (edge_hash(i, j, kind, 0) >> 8) / 2.0**24 - 1.0


@njit(cache=True, nogil=True)
def _octave(x: float, y: float, kind: int) -> float:
    """Value noise on the unit lattice, t^2 (3 - 2 t) between nodes."""
    i, j = math.floor(x), math.floor(y)
    u, v = x - i, y - j
    u, v = u * u * (3.0 - 2.0 * u), v * v * (3.0 - 2.0 * v)
    low = (1.0 - u) * _node(i, j, kind) + u * _node(i + 1, j, kind)
    high = (1.0 - u) * _node(i, j + 1, kind) + u * _node(i + 1, j + 1, kind)
    return (1.0 - v) * low + v * high


@njit(cache=True, nogil=True)
def patches(x: float, y: float) -> float:
    """Smooth value in [-1, 1] without a period, by which the brightness of bare ground varies; x, y in metres.

    Two octaves of value noise (Perlin 1985), hashed as kinds 5 and 6; the fine one is turned by the angle whose cosine
    is 0.8.
    """
    coarse = _octave(x / COARSE, y / COARSE, 5)
    fine = _octave((0.8 * x - 0.6 * y) / FINE, (0.6 * x + 0.8 * y) / FINE, 6)
    return COARSE_SHARE * coarse + (1.0 - COARSE_SHARE) * fine


@njit(cache=True, nogil=True)
def kept(scene: Scene, x: float, y: float) -> float:
    """Share of what stands at a place that is seen: 1 in the square, fading with the distance beyond it."""
    half = 0.5 * (scene.elevation.shape[0] - 1) * scene.cell
    east, north = max(abs(x) - half, 0.0), max(abs(y) - half, 0.0)
    return math.exp(-(east * east + north * north) / (scene.fade * scene.fade))
