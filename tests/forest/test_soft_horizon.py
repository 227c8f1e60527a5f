"""Soft horizons of the canopy: light through slabs and crowns in closed form, the fit, and where its azimuths look."""

from __future__ import annotations

import math

import numpy as np
import pytest

from renderer.core.errors import Cancelled
from renderer.forest.horizon_textures import stacked_at
from renderer.forest.soft_horizon import (
    ELEVATIONS,
    GAMMA_RANGE,
    SPREAD_RANGE,
    bake_soft_horizon,
    candidates,
    fit,
    gather_light,
    probe_weights,
)
from renderer.forest.tiles import lattice
from renderer.forest.world_scale import CANOPY_HEIGHT, VOXEL

HEIGHTS = [0.0, 0.5, 1.0]
BLOCK = 160 / 64
RNG = np.random.default_rng(6)


def silent(share: float, words: str) -> None:
    """Hear no progress."""


def pattern(alpha: np.ndarray) -> dict[str, dict[str, np.ndarray]]:
    """The inputs of a bake: opacities (K, J, I) of 255."""
    colour = np.zeros((*alpha.shape, 4), np.uint8)
    colour[..., 3] = alpha
    return {"pattern": {"colour": colour}}


def baked(alpha: np.ndarray, sectors: int = 4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gamma and spread [rad] and clear share, (chi, heights, J, I)."""
    found = bake_soft_horizon({"sectors": sectors, "heights": HEIGHTS}, pattern(alpha), silent)["soft"] / 255
    gamma, spread = (found[..., n] * (high - low) + low for n, (low, high) in enumerate((GAMMA_RANGE, SPREAD_RANGE)))
    return gamma, spread, found[..., 2]


def smoothstep(gamma: float, spread: float) -> np.ndarray:
    t = np.clip((ELEVATIONS - gamma + spread) / (2 * spread), 0, 1)
    return t * t * (3 - 2 * t)


@pytest.mark.parametrize("elevation", [9.0, 30.0, 75.0])
def test_light_through_a_slab_is_beers(elevation: float) -> None:
    """exp(-sigma d / sin): d the thickness above the layer's centre."""
    sigma, layer, turned = 0.05, 0.625, math.radians(elevation)
    extinction = np.full((32, 16, 16), sigma, np.float32)
    weights = np.zeros((2, 32, 16, 16), np.float32)
    weights[0, 0], weights[1, 20] = 1, 1
    shares = np.empty((2, 16, 16), np.float32)
    shift = np.array([0.7, -0.4]) / math.tan(turned)
    gather_light(extinction, shift, layer / math.sin(turned), 2, weights, np.empty_like(extinction), shares)
    for found, k in zip(shares, (0, 20), strict=True):
        np.testing.assert_allclose(found, math.exp(-sigma * (31.5 - k) * layer / math.sin(turned)), rtol=2e-4)


def light_from(shift: tuple[float, float]) -> np.ndarray:
    """Light at the ground in a world of one opaque voxel, 10 layers up, at row 8, column 5."""
    extinction = np.zeros((32, 16, 16), np.float32)
    extinction[10, 8, 5] = 50.0
    weights = np.zeros((1, 32, 16, 16), np.float32)
    weights[0, 0] = 1
    shares = np.empty((1, 16, 16), np.float32)
    gather_light(extinction, np.array(shift), 0.7, 1, weights, np.empty_like(extinction), shares)
    return shares[0]


@pytest.mark.parametrize("shift", [(0.5, 0.2), (-0.3, 0.4), (1.0, -0.6), (0.0, 0.0)])
def test_a_voxel_shades_what_lies_against_the_light(shift: tuple[float, float]) -> None:
    dark = np.argwhere(light_from(shift) < 0.01)
    assert [((8 - 10 * shift[1]) % 16, (5 - 10 * shift[0]) % 16)] == [tuple(place) for place in dark.tolist()]


def fitted(shares: np.ndarray) -> np.ndarray:
    """What the fit makes of light (E, N), its smoothsteps at the same elevations."""
    pairs, steps, calm = candidates(ELEVATIONS)
    chosen, clear = np.empty(shares.shape[1], np.int32), np.empty(shares.shape[1], np.float32)
    fit(shares.astype(np.float32), steps, calm, chosen, clear)
    return np.stack([share * smoothstep(*pairs[n]) for n, share in zip(chosen, clear, strict=True)], axis=1)


@pytest.mark.parametrize(
    ("gamma", "spread", "clear"), [(20, 8, 1), (35, 13, 0.5), (50, 46, 0.8), (5, 26, 0.3), (-30, 1, 1)]
)
def test_a_candidate_is_found_again(gamma: float, spread: float, clear: float) -> None:
    shares = clear * smoothstep(math.radians(gamma), math.radians(spread))
    np.testing.assert_allclose(fitted(shares[:, None])[:, 0], shares, atol=0.03)


def test_a_fit_is_near_the_best_there_is() -> None:
    """Twin: a finer grid of angles and shares, without a preference for calm."""
    gammas, spreads, clear = np.meshgrid(np.arange(-30, 90, 4.0), np.arange(1, 61, 4.0), np.arange(0, 1.01, 0.05))
    t = np.clip((np.degrees(ELEVATIONS)[:, None] - gammas.ravel() + spreads.ravel()) / (2 * spreads.ravel()), 0, 1)
    every = clear.ravel() * t * t * (3 - 2 * t)
    shares = np.sort(RNG.uniform(0, 1, (len(ELEVATIONS), 80)), axis=0) * RNG.uniform(0.2, 1, 80)
    worse = ((fitted(shares) - shares) ** 2).sum(axis=0)
    best = np.array([((every - column[:, None]) ** 2).sum(axis=0).min() for column in shares.T])
    assert np.median(worse - best) < 0.005
    assert (worse - best).max() < 0.05


def test_open_air_is_lit_and_a_solid_canopy_is_not() -> None:
    gamma, spread, clear = baked(np.zeros((32, 64, 64), np.uint8))
    assert (gamma + spread < math.radians(5)).all()
    assert (clear == 1).all()
    _, _, clear = baked(np.full((32, 64, 64), 255, np.uint8))
    assert (clear[:, :2] == 0).all()


def test_a_wall_hides_its_own_side() -> None:
    """A solid row along i, as high as the canopy: its neighbours to the south cannot see north, and the reverse."""
    alpha = np.zeros((32, 64, 64), np.uint8)
    alpha[:, 30] = 255
    gamma, _, _ = baked(alpha, sectors=4)
    away = 9
    rise = math.atan(CANOPY_HEIGHT / (away * lattice(BLOCK)[1, 1]))
    north, south = gamma[0, 0, :, 10], gamma[2, 0, :, 10]
    assert north[30 - away] == pytest.approx(rise, abs=math.radians(9))
    assert south[30 + away] == pytest.approx(rise, abs=math.radians(9))
    assert north[30 + away] < 0.5 * rise
    assert south[30 - away] < 0.5 * rise


def test_light_grows_with_height_under_an_even_canopy() -> None:
    gamma, spread, clear = baked(np.full((32, 64, 64), 20, np.uint8))
    t = np.clip((math.radians(40) - gamma + spread) / (2 * spread), 0, 1)
    lit = (clear * t * t * (3 - 2 * t)).mean(axis=(0, 2, 3))
    assert (np.diff(lit) > 0.02).all()
    # exp(-sigma d / sin phi) at the ground, sigma of 20 of 255.
    depth = -math.log(1 - 20 / 255) / VOXEL * (CANOPY_HEIGHT - VOXEL / 2) / math.sin(math.radians(40))
    assert lit[0] == pytest.approx(math.exp(-depth), abs=0.03)


def test_probes_weigh_matter_and_the_lowest_is_the_ground() -> None:
    extinction = np.where(RNG.random((32, 4, 4)) < 0.3, 1.0, 0.0).astype(np.float32)
    weights = probe_weights(extinction, np.array(HEIGHTS))
    np.testing.assert_allclose(weights.sum(axis=1), 1, rtol=1e-5)
    assert (weights[0, 1:] == 0).all()
    # Between the upper probes a voxel of matter counts far more than one of air.
    full, air = (weights[1, 15:17][extinction[15:17] == value] for value in (1.0, 0.0))
    assert full.min() > 10 * air.max()


def test_heights_are_stacked_and_blended_by_azimuth() -> None:
    soft = RNG.integers(0, 256, (8, 4, 5, 6, 3), np.uint8)
    for azimuth in (0.0, 0.3, 3.0, 6.2, -1.0, 2 * math.pi):
        found = stacked_at(soft, azimuth).astype(int).reshape(4, 7, 6, 4)
        place = azimuth / (2 * math.pi) * 8 % 8
        first, share = int(place) % 8, place % 1
        exact = soft[first] * (1 - share) + soft[(first + 1) % 8] * share
        wrapped = np.concatenate([exact[:, -1:], exact, exact[:, :1]], axis=1)
        assert np.abs(found[..., :3] - wrapped).max() <= 1.5


def test_a_bake_can_be_stopped() -> None:
    def stop(share: float, words: str) -> None:
        raise Cancelled

    with pytest.raises(Cancelled):
        bake_soft_horizon({"sectors": 4, "heights": HEIGHTS}, pattern(np.zeros((32, 64, 64), np.uint8)), stop)


def test_the_voxel_is_the_opacitys_length() -> None:
    """A layer is as thick as the length that opacity is meant for: light straight up follows from the bytes."""
    assert CANOPY_HEIGHT / 32 == VOXEL
