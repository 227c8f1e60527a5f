"""The march itself: lookups against plain Python, skipping against not skipping, convergence, and honest errors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from renderer.reference import forest_lookup as lookup
from renderer.reference.forest import Options, render
from renderer.reference.forest_light import visibility
from renderer.reference.forest_march import ALL, COLUMNS, NONE, NOT_OWN, ONLY_OWN, march
from renderer.reference.forest_world import EVERYWHERE, prepare
from tests.reference.worlds import CENTRE, flat, grove, looking, unit

NOWHERE = np.empty((0, COLUMNS))
POINTS = np.random.default_rng(8).uniform(-100, 100, (60, 2))


def plain_hash(i: int, j: int, d: int, seed: int) -> int:
    """The definition, in Python's unbounded integers."""
    wrap = 2**32
    x = (i * 0x8DA6B343 % wrap) ^ (j * 0xD8163841 % wrap) ^ (d * 0xCB1AB31F % wrap) ^ (seed * 0x165667B1 % wrap)
    x ^= x >> 16
    x = x * 0x7FEB352D % wrap
    x ^= x >> 15
    x = x * 0x846CA68B % wrap
    return x ^ (x >> 16)


def test_hash_wraps_as_32_bits_do() -> None:
    for i, j, d, seed in [(0, 0, 0, 0), (1, 2, 3, 4), (-1, -7, 2, 11), (123456, -98765, 4, 2**31)]:
        assert lookup.edge_hash(i, j, d, seed) == plain_hash(i, j, d, seed)


def test_neighbouring_triangles_agree_on_the_edge_between_them() -> None:
    # a table that holds each triangle's own colours makes the lookup confess which edges it asked for
    table = np.zeros((2, 2, 8, 2), np.uint8)
    for index in range(8):
        table[:, :, index] = (index & 3, index >> 2)
    scene = prepare(flat(0, tile=table))
    for i in range(-3, 4):
        for j in range(-3, 4):
            up, down = lookup.rhombus(scene, i, j, 0), lookup.rhombus(scene, i, j, 1)
            bottom, left, diagonal = (plain_hash(i, j, d, 7) & 1 for d in range(3))
            top, right = plain_hash(i, j + 1, 0, 7) & 1, plain_hash(i + 1, j, 1, 7) & 1
            assert up == (bottom + 2 * left, diagonal)
            assert down == (top + 2 * right, diagonal)


def test_atlas_lookup_is_trilinear_and_wraps() -> None:
    rng = np.random.default_rng(4)
    scene = prepare(flat(rng.integers(0, 256, (5, 8, 8))))
    for tu, tv, tk in rng.uniform(-1, 8, (50, 3)):
        expected = 0.0
        for k, j, i in np.ndindex(2, 2, 2):
            at = [int(np.floor(t)) + o for t, o in zip((tu, tv, tk), (i, j, k), strict=True)]
            weight = np.prod([1 - abs(t - a) for t, a in zip((tu, tv, tk), at, strict=True)])
            expected += weight * scene.colour[np.clip(at[2], 0, 4), at[1] % 8, at[0] % 8, 3] / 255
        assert lookup.alpha_at(scene, EVERYWHERE, 0.0, 0.0, tu, tv, tk) == pytest.approx(expected)
        voxel = np.empty(8)
        lookup.voxel_at(scene, 0.0, 0.0, tu, tv, tk, voxel)
        assert voxel[3] == pytest.approx(expected)
        assert voxel[4:6] == pytest.approx([128 / 255] * 2)


def test_lattice_coordinates_give_back_the_place() -> None:
    scene = prepare(flat(0))
    for x, y in POINTS:
        u, v = lookup.lattice(scene, x, y)
        assert (u * 40 + v * 20, v * 40 * np.sqrt(0.75)) == pytest.approx((x, y))


def test_a_foot_is_the_same_for_all_samples_of_a_voxel() -> None:
    world = grove()
    scene = prepare(world)
    step = 160 / world.colour.shape[2]
    x, y = 11.0, 7.0
    tu, tv = lookup.texel(scene, x, y)
    tu, tv = np.floor(tu) + 0.1, np.floor(tv) + 0.2
    here = lookup.foot(scene, x, y, tu, tv, 9.0, True)
    # a move within the voxel by 0.2 texels along the second edge direction
    there = lookup.foot(scene, x + 0.2 * step / 2, y + 0.2 * step * np.sqrt(0.75), tu, tv + 0.2, 9.0, True)
    assert there == pytest.approx(here)
    assert lookup.foot(scene, x, y, tu, tv, 9.0, False) != pytest.approx(here)


def depths(scene, step: float = 0.1) -> np.ndarray:
    """Optical depth along slanted rays through a scene, ground and all."""
    found = []
    for n, (x, y) in enumerate(POINTS):
        d = tuple(unit((np.cos(n), np.sin(n), -0.15 - 0.7 * (n % 5) / 5)))
        found.append(march(scene, (x, y, 40.0), d, 0.0, 0.0, 1e9, step, True, ALL, (0.0, 0.0), NOWHERE)[2])
    return np.array(found)


def test_skipping_empty_space_changes_nothing() -> None:
    scene = prepare(grove())
    # steps land elsewhere when nothing is skipped: the two differ by the rule's own error, which fine steps make small
    skipped, whole = depths(scene, 0.01), depths(scene._replace(safe=np.zeros_like(scene.safe)), 0.01)
    assert whole.max() > 5
    assert skipped == pytest.approx(whole, rel=2e-3, abs=2e-3)
    # distances one too long must be noticed
    greedy = np.where(scene.safe > 0, np.minimum(scene.safe.astype(int) + 4, 255), 0).astype(np.uint8)
    assert depths(scene._replace(safe=greedy), 0.01) != pytest.approx(whole, rel=2e-3, abs=2e-3)


def test_skipping_terrain_blocks_changes_nothing() -> None:
    scene = prepare(grove())
    assert depths(scene) == pytest.approx(
        depths(scene._replace(block_top=np.full_like(scene.block_top, 1e6))), rel=0.02, abs=0.02
    )
    assert (scene.block_top.max(), scene.top) == (scene.elevation.max(), scene.elevation.max())


def test_a_full_record_is_resumed_without_loss() -> None:
    scene = prepare(grove())
    d = tuple(unit((0.5, 0.2, -0.3)))
    whole = march(scene, (-60.0, 0.0, 40.0), d, 0.0, 0.0, 1e9, 0.1, True, ALL, (0.0, 0.0), NOWHERE)
    record, s, tau, status, parts = np.empty((3, COLUMNS)), 0.0, 0.0, 3, 0
    while status == 3:
        status, s, tau, _ = march(scene, (-60.0, 0.0, 40.0), d, s, tau, 1e9, 0.1, True, ALL, (0.0, 0.0), record)
        parts += 1
    assert parts > 3
    assert whole[2] > 0
    assert (status, s) == (whole[0], pytest.approx(whole[1]))
    # a resumed march starts its cell anew, so the steps that straddle the cut differ
    assert tau == pytest.approx(whole[2], rel=0.02)


def test_ground_is_hit_exactly_on_the_bilinear_surface() -> None:
    scene = prepare(grove(cover=np.zeros((33, 33))))
    for n, (x, y) in enumerate(POINTS):
        d = unit((np.cos(n), np.sin(n), -0.4))
        status, s, _, _ = march(scene, (x, y, 60.0), tuple(d), 0.0, 0.0, 1e9, 0.1, True, ALL, (0.0, 0.0), NOWHERE)
        hit = np.array([x, y, 60.0]) + s * d
        assert status == 1
        assert hit[2] == pytest.approx(lookup.bilinear(scene.elevation, 8.0, hit[0], hit[1]), abs=1e-9)


def test_own_tree_and_other_trees_multiply_to_all() -> None:
    world = grove()
    scene = prepare(world)
    switches = np.array([1] * 4 + [0])
    seen = []
    for x, y in POINTS:
        z = lookup.bilinear(scene.elevation, 8.0, x, y) + 8.0
        tu, tv = lookup.texel(scene, x, y)
        tk = 0.4 * 32 - 0.5
        if lookup.alpha_at(scene, EVERYWHERE, 0.0, 0.0, tu, tv, tk) == 0:
            continue
        own = lookup.foot(scene, x, y, tu, tv, tk, True)
        v = {
            mode: visibility(scene, switches, x, y, z, 0.05, mode, own, NOWHERE)
            for mode in (ALL, NOT_OWN, ONLY_OWN, NONE)
        }
        assert v[ALL] == pytest.approx(v[NOT_OWN] * v[ONLY_OWN], abs=1e-6)
        assert v[NONE] in (0.0, 1.0)
        seen.append((v[NOT_OWN], v[ONLY_OWN]))
    own_shade, others_shade = np.array(seen)[:, 1], np.array(seen)[:, 0]
    assert (own_shade < 0.9).any()
    assert (others_shade < 0.9).any()


def test_error_falls_with_the_square_of_the_step() -> None:
    world = grove()
    rays = looking(np.random.default_rng(3).uniform(-60, 100, (150, 2)), (0.3, 0.2, -0.6))

    def at(factor: int) -> np.ndarray:
        step = 0.8 / factor
        options = Options(shadow_rays=0, steps_per_crossing=64 * factor, longest_step=step, shadow_step=step)
        return render(world, rays, CENTRE, options).radiance[..., :3]

    truth = at(32)
    errors = [float(np.sqrt(np.mean((at(f) - truth) ** 2)) / truth.mean()) for f in (1, 4, 8)]
    order = np.log2(errors[0] / errors[1]) / 2
    # midpoint rule: 2 within a voxel; steps that straddle a voxel's or a tree's border pull it down
    assert order > 1.2
    # 512 steps a crossing
    assert errors[2] < 2e-3
    # what the reference itself leaves, with the longer steps of its defaults
    default = render(world, rays, CENTRE, Options(shadow_rays=0)).radiance[..., :3]
    assert float(np.sqrt(np.mean((default - truth) ** 2)) / truth.mean()) < 4e-3
    assert default.mean() == pytest.approx(truth.mean(), rel=5e-4)


def test_sampled_shadows_agree_with_a_shadow_ray_at_every_step() -> None:
    world = grove()
    rays = looking(np.random.default_rng(3).uniform(-60, 100, (300, 2)), (0.3, 0.2, -0.6))
    truth = render(world, rays, CENTRE, Options(shadow_rays=0)).radiance[0, :, :3].mean(axis=-1)
    draws = [render(world, rays, CENTRE, Options(shadow_rays=4, seed=seed)) for seed in range(24)]
    values = np.array([d.radiance[0, :, :3].mean(axis=-1) for d in draws])
    spread = values.std(axis=0, ddof=1)
    # the mean of 24 draws lies within its own error of the truth: no bias
    bias = float(np.mean(values.mean(axis=0) - truth))
    assert abs(bias) < 4 * float(np.sqrt(np.mean(spread**2) / 24 / len(truth)))
    assert float(np.sqrt(np.mean((values.mean(axis=0) - truth) ** 2))) < 1.5 * float(np.sqrt(np.mean(spread**2) / 24))
    # and the stated error is what another seed shows, or more
    stated = float(np.sqrt(np.mean([d.standard_error**2 for d in draws])))
    actual = float(np.sqrt(np.mean(spread**2)))
    assert actual <= 1.05 * stated
    assert stated < 4 * actual
    assert len({d.radiance.tobytes() for d in draws}) == 24, "seeds differ"
    again = render(world, rays, CENTRE, Options(shadow_rays=4, seed=0))
    assert again.radiance.tobytes() == draws[0].radiance.tobytes()


def test_unshadowed_light_needs_no_luck() -> None:
    world = grove(nodes=33)
    rays = looking(POINTS)
    off = {"terrain": False, "forest_on_ground": False, "tree_on_tree": False, "within_tree": False}
    sampled = render(world, rays, CENTRE, Options(shadow_rays=2, **off))
    exact = render(world, rays, CENTRE, Options(shadow_rays=0, **off))
    assert sampled.standard_error.max() == 0
    assert sampled.radiance.mean(axis=-1) == pytest.approx(exact.radiance.mean(axis=-1), rel=1e-9)


def test_each_shadow_can_be_taken_away_alone() -> None:
    world = grove(sun=tuple(unit((-0.8, 0.1, 0.25))))
    world = replace(world, elevation=world.elevation * 4)
    rays = looking(np.random.default_rng(3).uniform(-120, 110, (400, 2)), (0.2, 0.1, -0.7))
    everything = render(world, rays, CENTRE, Options(shadow_rays=0)).radiance[..., :3]
    gains = {}
    for name in ("terrain", "forest_on_ground", "tree_on_tree", "within_tree"):
        without = render(world, rays, CENTRE, Options(shadow_rays=0, **{name: False})).radiance[..., :3]
        assert (without >= everything - 1e-9).all(), "taking a shadow away never darkens"
        gains[name] = float((without - everything).mean() / everything.mean())
    assert all(gain > 1e-3 for gain in gains.values()), gains
