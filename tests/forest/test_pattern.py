"""The pattern: seams, canopy, feet, safe distances and sky light, on the default bake."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

from renderer.forest.edge_classes import CORNER, edge_distance, reduce_classes
from renderer.forest.pattern import AXES, CELL, LAYERS, SIZE, WOOD, bake_pattern
from renderer.forest.pattern_mips import coarser, decode, mips
from renderer.forest.planting import MARGIN, plant
from renderer.forest.safe_distance import REACH, safe_distance
from renderer.forest.tiles import BOTTOM, DIAGONAL, LEFT, RHOMBI, lattice, locate
from renderer.forest.world_scale import TILE_SIDE, VOXEL
from renderer.world.tree import Tree

ARGUMENTS = {"broadleaf": 1.0, "conifer": 0.8, "birch": 0.4, "mesh": "", "density": 1.0, "seed": 1}


@pytest.fixture(scope="module")
def pattern() -> dict[str, np.ndarray]:
    told: list[float] = []
    baked = dict(bake_pattern(ARGUMENTS, {}, lambda share, words: told.append(share)))
    assert told == sorted(told)
    assert len(told) > 30
    return baked


def seams(pattern: dict[str, np.ndarray]) -> int:
    """Bytes within two rows of an edge that are not the same around all edges of that direction and colour."""
    wrong = 0
    for name in ("colour", "normal", "anchor"):
        for channel in range(4):
            volume = pattern[name][..., channel]
            for direction in (BOTTOM, LEFT, DIAGONAL):
                near = np.tile(edge_distance(direction, CELL) < 2, (RHOMBI, RHOMBI))
                unlike = reduce_classes(volume, direction, np.min) != reduce_classes(volume, direction, np.max)
                wrong += int((unlike & near).sum())
    return wrong


def test_arrays_are_as_the_shaders_read_them(pattern):
    for name in ("colour", "normal", "anchor"):
        for level in range(6):
            array = pattern[name if level == 0 else f"{name}_{level}"]
            assert array.dtype == np.uint8
            assert array.shape == (LAYERS >> level, SIZE >> level, SIZE >> level, 4)
    assert (LAYERS, SIZE) == (32, 256)
    assert pattern["tile"].shape == (2, 2, 8, 2)
    colour = pattern["colour"]
    assert (colour[..., :3] <= colour[..., 3:]).all()


def test_no_seam_anywhere(pattern):
    assert seams(pattern) == 0


def test_an_unshared_voxel_would_show(pattern):
    spoiled = {name: pattern[name].copy() for name in ("colour", "normal", "anchor")}
    spoiled["colour"][10, 2 * CELL, 20, 3] ^= 64
    assert seams(spoiled) > 0
    assert seams({name: np.roll(pattern[name], 8, axis=2) for name in spoiled}) > 1000


def test_the_canopy_covers_most_but_not_all(pattern):
    opacity = pattern["colour"][..., 3] / 255
    covered = np.prod(1 - opacity, axis=0) < 0.5
    assert 0.75 < covered.mean() < 0.87
    assert opacity[-1].max() < 0.2
    # Corners carry no tree, but are no glades either: the rings around them are about as full as the rest.
    corner = np.tile(edge_distance(CORNER, CELL), (RHOMBI, RHOMBI))
    for inner, outer in ((3, 6), (6, 9), (9, 12), (12, 16), (16, 24)):
        assert 0.6 < covered[(corner >= inner) & (corner < outer)].mean() < 0.98


def test_feet_are_those_of_the_trees(pattern):
    """From nearly every voxel of matter the stored offset leads to a tree of the list."""
    full = pattern["colour"][..., 3] > 60
    k, j, i = np.nonzero(full)
    chosen = np.random.default_rng(0).integers(len(k), size=4000)
    k, j, i = k[chosen], j[chosen], i[chosen]
    place = np.stack([i + 0.5, j + 0.5], axis=-1) @ AXES
    foot = place + (pattern["anchor"][k, j, i, :2].astype(float) - 128) / 16
    period = lattice(RHOMBI * TILE_SIDE)
    images = np.concatenate([pattern["trees"][:, :2] + (np.array(step) - 1) @ period for step in np.ndindex(3, 3)])
    gap, _ = cKDTree(images).query(foot)
    # A sixteenth of a metre a step: half of it, along the diagonal.
    assert np.quantile(gap, 0.999) < 0.05
    wood = pattern["anchor"][..., 3]
    assert 0.01 < (wood[full] >= WOOD).mean() < 0.4
    assert (wood[~(pattern["colour"][..., 3] > 0)] < WOOD).all(), "no wood in air"


def test_safe_distances_hold_on_every_map(pattern):
    """Around random points of random maps no matter is nearer than promised, on this tile or any neighbour."""
    full = pattern["colour"][..., 3] > 0
    promised = pattern["anchor"][..., 2]
    assert (promised[full] == 0).all()
    assert promised.max() >= 6
    rng = np.random.default_rng(6)
    uv = rng.integers(-400 * CELL, 400 * CELL, (4000, 2))
    k = rng.integers(0, LAYERS, 4000)
    here = texels(uv, seed=3)
    distance = promised[k, here[1], here[0]].astype(int)
    for n in np.flatnonzero(distance >= 2)[:400]:
        reach = distance[n] - 1
        steps = np.arange(-reach, reach + 1)
        around = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2) + uv[n]
        i, j = texels(around, seed=3)
        assert not full[max(k[n] - reach, 0) : k[n] + reach + 1, j, i].any()


def texels(uv: np.ndarray, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Voxel (i, j) of the atlas at whole voxels (n, 2) of the world's lattice."""
    place = locate((uv + 0.5) @ AXES, TILE_SIDE, seed)
    return np.floor(place.u * SIZE).astype(int), np.floor(place.v * SIZE).astype(int)


def test_safe_distances_are_worth_something(pattern):
    """They reach most of the way that is really free inside the atlas, where the canopy is open above."""
    full = pattern["colour"][..., 3] > 0
    air = full.any(axis=0)
    top = np.where(air, LAYERS - full[::-1].argmax(axis=0), 0)
    assert pattern["anchor"][LAYERS - 1, ..., 2].mean() > 1.5
    assert (pattern["anchor"][LAYERS - 1, ..., 2][top == LAYERS] <= 1).all()


def test_safe_distance_of_one_post_is_its_chebyshev_distance():
    full = np.zeros((32, 64, 64), bool)
    full[:20, 5, 6] = True
    distance = safe_distance(full)
    assert distance[10, 5, 6] == 0
    assert distance[10, 5, 8] == 2
    assert distance[24, 6, 7] == 5
    assert distance.max() <= REACH


def test_sky_light_grows_from_the_ground_to_the_top(pattern):
    ambient = pattern["normal"][..., 3].mean(axis=(1, 2)) / 255
    assert (np.diff(ambient) > -0.005).all()
    assert ambient[-1] > 0.97
    assert 0.005 < ambient[0] < 0.2


def test_normals_are_means_and_face_the_sky_on_the_crowns(pattern):
    _, normal = decode(pattern)
    full = pattern["colour"][..., 3] > 0
    wood = full & (pattern["anchor"][..., 3] >= WOOD)
    length = np.linalg.norm(normal[..., :3], axis=-1)
    assert length.max() < 1.01
    # Leaves agree in the main; those all round a thin branch do not.
    assert 0.6 < length[full & ~wood].mean() < 0.95
    assert length[wood].mean() < 0.6
    opacity = pattern["colour"][..., 3] / 255
    above = np.cumprod((1 - opacity)[::-1], axis=0)[::-1]
    crust = (above > 0.5) & (opacity > 0.2)
    assert normal[..., 2][crust].mean() > 0.3


def test_coarser_levels_of_fog_and_of_a_post():
    """Formulas b3: fog composes along the ray; a post hides one ray in four along itself, one in two across."""
    fog = np.full((2, 2, 2, 4), 0.25, np.float32)
    normal = np.zeros((2, 2, 2, 4), np.float32)
    normal[..., 2:] = 1
    anchor = np.zeros((2, 2, 2, 4), np.uint8)
    colour, _, _ = coarser(fog, normal, anchor)
    np.testing.assert_allclose(colour[0, 0, 0], 1 - 0.75**2, rtol=1e-6)
    post = np.zeros((2, 2, 2, 4), np.float32)
    post[:, 0, 0] = (0.1, 0.2, 0.05, 1.0)
    colour, _, _ = coarser(post, normal, anchor)
    opacity = (0.25 + 0.5 + 0.5) / 3
    np.testing.assert_allclose(colour[0, 0, 0], [0.1 * opacity, 0.2 * opacity, 0.05 * opacity, opacity], rtol=1e-6)


def test_levels_keep_the_canopy_opaque(pattern):
    """Through the whole layer a coarse level hides on average what the finest hides."""
    fine = np.prod(1 - pattern["colour"][..., 3] / 255.0, axis=0).mean()
    for level in (1, 2, 3):
        coarse = np.prod(1 - pattern[f"colour_{level}"][..., 3] / 255.0, axis=0).mean()
        assert 0.3 * fine < coarse < 1.3 * fine
    again = mips(pattern)
    np.testing.assert_array_equal(again[0]["colour"], pattern["colour_1"])


def slim() -> Tree:
    """A pole with a small crown."""
    vertices = np.array([[0, 0, 0], [2.2, 0, 9], [-2.2, 0, 9], [0, 2.2, 12.0]])
    return Tree(vertices, np.array([[0, 1, 2], [1, 3, 2]]), np.ones((2, 3), np.float32), np.zeros(2, bool))


def edges() -> tuple[np.ndarray, np.ndarray]:
    """Both ends of every edge of the lattice near the origin, (n, 2) each."""
    cells = np.array([(i, j) for i in range(-2, 3) for j in range(-2, 3)])
    a, b, c = (cells + step for step in ((0, 0), (1, 0), (0, 1)))
    base = lattice(TILE_SIDE)
    return np.concatenate([a, a, b]) @ base, np.concatenate([b, c, c]) @ base


def test_trees_cross_one_edge_at_most_and_cover_no_corner():
    start, end = edges()
    for tree in plant([slim()], [0], np.ones(1), 0.4, 5):
        along = ((tree.foot - start) * (end - start)).sum(axis=1) / TILE_SIDE**2
        away = np.linalg.norm(tree.foot - start - np.clip(along, 0, 1)[:, None] * (end - start), axis=1) - tree.reach
        assert (away < 0).sum() <= 1
        assert np.linalg.norm(tree.foot - start, axis=1).min() > tree.reach
        # Beside the corners' own trees, the same everywhere, a crown keeps four voxels off all edges but its own.
        allowed = {16: 6, 8: 1, 1: 0}[len(tree.cells)]
        assert (away < MARGIN - 1e-9).sum() <= allowed


def test_density_thins_the_stand_and_a_seed_is_a_stand():
    def count(density: float, seed: int) -> list[float]:
        return [float(tree.foot[0]) for tree in plant([slim()], [0], np.ones(1), density, seed)]

    dense, sparse = count(0.25, 2), count(0.1, 2)
    assert len(sparse) < 0.6 * len(dense)
    assert count(0.1, 2) == sparse
    assert count(0.1, 3) != sparse


def test_voxels_are_small_enough_for_the_offsets():
    assert AXES[0, 0] == VOXEL
    assert abs(np.linalg.det(AXES)) == pytest.approx(VOXEL**2 * np.sqrt(0.75))
