"""A second writing of the world in plain numpy, without cells, triangles or skipping: many even steps along a ray."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from renderer.reference.forest import Options, render
from renderer.reference.forest_light import visibility
from renderer.reference.forest_march import ALL, COLUMNS
from renderer.reference.forest_world import ForestWorld, prepare
from tests.reference.worlds import CENTRE, grove, looking, unit

UNSHADOWED = Options(terrain=False, forest_on_ground=False, tree_on_tree=False, within_tree=False)
WORLD = grove(trees=8)
LEAFY = np.concatenate([WORLD.anchor[..., :3], np.zeros_like(WORLD.anchor[..., 3:])], axis=-1)


def nodes(grid: np.ndarray, cell: float, xy: np.ndarray) -> np.ndarray:
    """Bilinear values of a node grid."""
    last = grid.shape[0] - 1
    place = np.clip(np.stack([last / 2 - xy[:, 1] / cell, last / 2 + xy[:, 0] / cell], axis=1), 0, last)
    corner = np.minimum(place.astype(int), last - 1)
    (i, j), (v, u) = corner.T, (place - corner).T
    north, south = grid[i, j] * (1 - u) + grid[i, j + 1] * u, grid[i + 1, j] * (1 - u) + grid[i + 1, j + 1] * u
    return north * (1 - v) + south * v


def hashed(i: np.ndarray, j: np.ndarray, d: np.ndarray | int, seed: int) -> np.ndarray:
    """The hash in numpy's own 32-bit words."""
    with np.errstate(over="ignore"):
        x = i.astype(np.uint32) * np.uint32(0x8DA6B343) ^ j.astype(np.uint32) * np.uint32(0xD8163841)
        x ^= np.uint32(d) * np.uint32(0xCB1AB31F) ^ np.uint32(seed) * np.uint32(0x165667B1)
        x = (x ^ x >> np.uint32(16)) * np.uint32(0x7FEB352D)
        x = (x ^ x >> np.uint32(15)) * np.uint32(0x846CA68B)
    return x ^ x >> np.uint32(16)


def sample(world: ForestWorld, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Extinction, the atlas' eight channels and the tint of points (M, 3)."""
    xy, layers, size = points[:, :2], *world.colour.shape[:2]
    h = (points[:, 2] - nodes(world.elevation, world.cell, xy)) / world.canopy_height
    basis = np.array([[1, 0], [0.5, np.sqrt(0.75)]]) * world.tile_side
    u, v = (xy @ np.linalg.inv(basis)).T
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    down = (u - i + v - j >= 1).astype(int)
    bottom, left = hashed(i, j + down, 0, world.seed) & 1, hashed(i + down, j, 1, world.seed) & 1
    diagonal, variant = hashed(i, j, 2, world.seed) & 1, hashed(i, j, 3 + down, world.seed) & 1
    p, q = world.tile[down, variant, bottom + 2 * left + 4 * diagonal].astype(int).T
    place = np.stack([h * layers, (q + v - j) * size / 4, (p + u - i) * size / 4], axis=1)
    corner = np.floor(place - 0.5).astype(int)
    part = place - 0.5 - corner
    total = np.zeros((len(points), 8))
    for step in np.ndindex(2, 2, 2):
        at = corner + step
        k, row, column = np.clip(at[:, 0], 0, layers - 1), at[:, 1] % size, at[:, 2] % size
        weight = np.prod(np.where(step, part, 1 - part), axis=1)[:, None] / 255
        total += weight * np.concatenate([world.colour[k, row, column], world.normal[k, row, column]], axis=1)
    k, row, column = np.clip(place[:, 0].astype(int), 0, layers - 1), *(place[:, 1:].astype(int).T % size)
    feet = xy + (world.anchor[k, row, column, :2] - 128.0) / 16
    exists = (h > 0) & (h < 1) & (nodes(world.cover, world.cell, feet) > 0.5)
    sigma = -np.log(1 - np.minimum(total[:, 3], 1 - 2.0**-12)) / world.voxel * exists
    x, y = feet.T
    return sigma, total, np.sin(x * 0.37 + 1.3 * np.sin(y * 0.11)) * np.sin(y * 0.41 + 1.7 * np.sin(x * 0.13))


def brute(world: ForestWorld, origin: np.ndarray, direction: np.ndarray, step: float) -> tuple[np.ndarray, float]:
    """Unshadowed canopy radiance and opacity in front of the ground."""
    s = np.arange(step / 2, 160, step)
    points = origin + s[:, None] * direction
    under = points[:, 2] < nodes(world.elevation, world.cell, points[:, :2])
    points = points[: int(np.argmax(under)) if under.any() else len(points)]
    sigma, atlas, tint = sample(world, points)
    depth = np.concatenate([[0], np.cumsum(sigma * step)])
    weight = np.exp(-depth[:-1]) - np.exp(-depth[1:])
    normal = atlas[:, 4:7] * 2 - 1
    albedo = atlas[:, :3] / np.maximum(atlas[:, 3:4], 1e-9) * (1 + world.tint_strength * tint[:, None])
    met = weight > 0
    light = np.zeros_like(albedo)
    light[met] = scattered(world, normal[met], -direction, albedo[met], atlas[met, 7:8])
    return (weight[:, None] * light).sum(axis=0), 1 - np.exp(-depth[-1])


def scattered(
    world: ForestWorld, normal: np.ndarray, to_eye: np.ndarray, albedo: np.ndarray, ambient: np.ndarray
) -> np.ndarray:
    """What leaves send to the eye, leaf by leaf: some lie across the mean normal, the others in 1500 directions."""
    n = np.arange(1500) + 0.5
    z, turn = 1 - n / 750, n * np.pi * (1 + np.sqrt(5))
    wild = np.stack([np.sqrt(1 - z**2) * np.cos(turn), np.sqrt(1 - z**2) * np.sin(turn), z], axis=1)
    kappa = np.minimum(np.linalg.norm(normal, axis=1, keepdims=True), 1.0)
    flat = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    passed = np.minimum(albedo * world.leaf_transmission, 1 - albedo)
    through, result = world.e_sky * ambient / np.pi, np.zeros_like(albedo)
    shown = kappa * np.abs(flat @ to_eye)[:, None] + (1 - kappa) * np.abs(wild @ to_eye).mean()
    for share, leaves in ((kappa, flat), (1 - kappa, wild)):
        seen, lit = leaves @ to_eye, leaves @ np.array(world.sun)
        # the side that the eye sees, and how much of the sky that side faces
        up = 0.5 * (1 + np.sign(seen) * leaves[:, 2])
        one, two = np.maximum(seen * lit, 0), np.maximum(-seen * lit, 0)
        of = (lambda a: a[:, None]) if leaves is flat else np.mean
        result += share * (albedo * of(one) + passed * of(two)) * world.e_sun / np.pi
        result += share * (albedo * of(np.abs(seen) * up) + passed * of(np.abs(seen) * (1 - up))) * through
    return result / shown


def test_unshadowed_canopy_agrees_with_even_steps() -> None:
    points, direction = np.random.default_rng(5).uniform(-30, 100, (40, 2)), unit((0.3, -0.4, -0.5))
    # a black ground, so that the canopy speaks alone
    world = replace(WORLD, ground_albedo=(0.0, 0.0, 0.0), anchor=LEAFY, leaf_transmission=(0.9, 0.5, 0.1))
    rays = looking(points, direction)
    found = render(world, rays, CENTRE, UNSHADOWED).radiance[0, :, :3]
    origins = rays((0.5, 0.5))[0][0]
    expected, opacity = zip(*[brute(world, origin, direction, 0.004) for origin in origins], strict=True)
    assert np.mean(opacity) > 0.2
    budget = 2e-3 * float(np.mean(expected))
    assert found.mean(axis=-1) == pytest.approx(np.mean(expected, axis=-1), rel=0.01, abs=budget)
    # upward and downward tiles exchanged are another forest
    turned = replace(world, tile=world.tile[::-1])
    other = [brute(turned, origin, direction, 0.02)[0] for origin in origins]
    assert np.abs(np.mean(other, axis=-1) - np.mean(expected, axis=-1)).mean() > 0.1 * np.mean(expected)


def test_visibility_agrees_with_even_steps_to_the_sun() -> None:
    scene, sun = prepare(WORLD), np.array(WORLD.sun)
    switches, nothing = np.array([1] * 4 + [0]), np.empty((0, COLUMNS))
    expected, found = [], []
    for x, y in np.random.default_rng(6).uniform(-30, 100, (40, 2)):
        start = np.array([x, y, nodes(WORLD.elevation, WORLD.cell, np.array([[x, y]]))[0] + 1.0])
        points = start + np.arange(0.002, 60, 0.004)[:, None] * sun
        blocked = (points[:, 2] < nodes(WORLD.elevation, WORLD.cell, points[:, :2])).any()
        expected.append(0.0 if blocked else np.exp(-0.004 * sample(WORLD, points)[0].sum()))
        found.append(visibility(scene, switches, *start, 0.02, ALL, (0.0, 0.0), nothing))
    assert found == pytest.approx(expected, abs=5e-3)
    assert 0.2 < np.mean(expected) < 0.9
