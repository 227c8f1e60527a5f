"""Sky light through the canopy, against the exponential integral and plain rays."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import map_coordinates
from scipy.special import expn

from renderer.forest.ambient import directions, sky_share
from renderer.forest.edge_classes import blend_edges, edge_distance, reduce_classes
from renderer.forest.tiles import lattice


def test_directions_cover_the_hemisphere_evenly():
    rays, shares = directions()
    np.testing.assert_allclose(np.linalg.norm(rays, axis=1), 1)
    assert shares.sum() == pytest.approx(1)
    np.testing.assert_allclose(shares @ rays, [0, 0, 0.5], atol=1e-12)
    np.testing.assert_allclose(shares @ rays**2, [1 / 3] * 3, atol=1e-12)


@pytest.mark.parametrize("sigma", [0.01, 0.05, 0.2])
def test_uniform_fog_lets_through_the_exponential_integral(sigma):
    """Mean of exp(-tau / sin e) over the hemisphere is E2(tau); four rings cost a hundredth or so."""
    share = sky_share(np.full((16, 32, 32), sigma), lattice(0.625), 0.625, lambda done: None)
    for k in (0, 8, 15):
        tau = sigma * (15.5 - k) * 0.625
        assert share[k].min() == pytest.approx(share[k].max(), abs=1e-5)
        assert share[k, 0, 0] == pytest.approx(expn(2, tau), abs=0.015)


def test_a_patchy_canopy_agrees_with_plain_rays():
    rng = np.random.default_rng(1)
    # A rhombus of 64 voxels a side leaves room between the edges, around which neighbours are blended.
    extinction = np.where(rng.random((12, 32, 32)) < 0.08, 1.0, 0.0).repeat(8, axis=1).repeat(8, axis=2)
    axes, layer = lattice(0.625), 0.625
    share = sky_share(extinction, axes, layer, lambda done: None)
    inside = np.argwhere(np.min([edge_distance(direction, 64) for direction in range(3)], axis=0) > 9)
    chosen = inside[rng.integers(len(inside), size=100)] + 64 * rng.integers(0, 4, (100, 2))
    points = [(int(k), int(j), int(i)) for k, (j, i) in zip(rng.integers(0, 12, 100), chosen, strict=True)]
    plain = np.array([_by_rays(extinction, axes, layer, point) for point in points])
    mine = np.array([share[point] for point in points])
    # Budget: two bilinear interpolations against one, samples half a voxel apart, and no blend of unlike surroundings.
    assert np.corrcoef(mine, plain)[0, 1] > 0.95
    assert abs(mine.mean() - plain.mean()) < 0.02


def _by_rays(extinction: np.ndarray, axes: np.ndarray, layer: float, point: tuple[int, int, int]) -> float:
    """Transmittance over the same directions by fine steps, in float64."""
    total = 0.0
    for ray, weight in zip(*directions(), strict=True):
        length = (len(extinction) - 0.5 - point[0]) * layer / ray[2]
        steps = np.arange(0.01, length, 0.02)
        place = steps[:, None] * ray
        ij = place[:, :2] @ np.linalg.inv(axes)
        k = np.round(point[0] + place[:, 2] / layer)
        sigma = map_coordinates(extinction, [k, point[1] + ij[:, 1], point[2] + ij[:, 0]], order=1, mode="grid-wrap")
        total += weight * np.exp(-sigma.sum() * 0.02)
    return total


def test_blending_changes_nothing_uniform_and_makes_edges_alike():
    flat = np.full((2, 256, 256), 0.7, np.float32)
    np.testing.assert_allclose(blend_edges(flat, 3.0, 8.0), flat, atol=1e-6)
    rough = np.random.default_rng(0).random((1, 256, 256)).astype(np.float32)
    blended = blend_edges(rough, 3.0, 8.0)
    # In the middle of a triangle nothing is touched.
    np.testing.assert_allclose(blended[0, 21, 21], rough[0, 21, 21], atol=1e-6)
    for direction in range(3):
        near = np.tile(edge_distance(direction, 64) < 2, (4, 4))
        spread = reduce_classes(blended, direction, np.max) - reduce_classes(blended, direction, np.min)
        assert spread[0][near].max() < 1e-6
        assert np.ptp(rough[0][near]) > 0.9
