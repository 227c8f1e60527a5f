"""Where there is matter: distances against all pairs, and rays that jump without missing a voxel."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from renderer.shells.texture.occupancy import FARTHEST, Wrap, distances, filled, ranges

SHAPE = (6, 9, 11)


def sparse(seed: int, shape: tuple[int, int, int] = SHAPE, voxels: int = 3) -> np.ndarray:
    rng = np.random.Generator(np.random.PCG64(seed))
    extinction = np.zeros(shape, np.float32)
    extinction.reshape(-1)[rng.choice(extinction.size, voxels, replace=False)] = rng.uniform(1, 2, voxels)
    return extinction


def nearest(occupied: np.ndarray, wrap: Wrap) -> np.ndarray:
    """Every voxel against every filled one, and its repetitions."""
    found = np.full(occupied.shape, FARTHEST)
    for k, j, i in itertools.product(*map(range, occupied.shape)):
        for at in np.argwhere(occupied):
            away = np.abs(at - (k, j, i))
            if wrap == "repeat":
                away[1:] = np.minimum(away[1:], np.array(occupied.shape[1:]) - away[1:])
            found[k, j, i] = min(found[k, j, i], away.max())
    return found


@pytest.mark.parametrize("wrap", ["repeat", "clamp"])
def test_distances_are_those_of_the_nearest(wrap: Wrap) -> None:
    occupied = sparse(1) > 0
    found = distances(occupied, wrap)
    np.testing.assert_array_equal(found, nearest(occupied, wrap))
    other: Wrap = "clamp" if wrap == "repeat" else "repeat"
    assert (found != nearest(occupied, other)).any()
    assert found.dtype == np.uint8
    assert distances(np.zeros(SHAPE, bool), wrap).min() == FARTHEST


@pytest.mark.parametrize("interpolated", [False, True])
def test_a_jump_misses_nothing_and_one_further_would(interpolated: bool) -> None:
    """Rays from anywhere in empty voxels, to the far end of their jump, read no matter on the way."""
    extinction = sparse(2, (16, 16, 16), 5)
    distance = distances(filled(extinction, "repeat", interpolated), "repeat").astype(int)
    rng = np.random.Generator(np.random.PCG64(4))
    place = rng.uniform(0, 16, (4000, 3))
    own = distance[tuple(place.astype(int).T)]
    place, own = place[own > 0], own[own > 0]
    direction = rng.standard_normal(place.shape)
    direction /= np.abs(direction).max(axis=1, keepdims=True)

    def met(jump: np.ndarray) -> int:
        """How many rays read matter while they cross `jump` voxels along their main axis."""
        points = place[:, None] + direction[:, None] * jump[:, None, None] * np.linspace(0, 1, 60)[:, None]
        inside = (points[..., 0] >= 0) & (points[..., 0] < 16)
        return int(((read(extinction, points, interpolated) > 0) & inside).any(axis=1).sum())

    assert met(own - 1 + 0.0) == 0
    assert met(own + 1.0) > 0


def read(extinction: np.ndarray, points: np.ndarray, interpolated: bool) -> np.ndarray:
    """Extinction at points in voxels' sides, [w, v, u], repeated along u and v and clamped along w."""
    if not interpolated:
        k = np.clip(np.floor(points[..., 0]).astype(int), 0, len(extinction) - 1)
        j, i = (np.floor(points[..., axis]).astype(int) % extinction.shape[axis] for axis in (1, 2))
        return extinction[k, j, i]
    low = np.floor(points - 0.5).astype(int)
    part = points - 0.5 - low
    total = np.zeros(points.shape[:-1])
    for corner in itertools.product((0, 1), repeat=3):
        weight = np.prod([part[..., axis] if corner[axis] else 1 - part[..., axis] for axis in range(3)], axis=0)
        k = np.clip(low[..., 0] + corner[0], 0, len(extinction) - 1)
        j, i = ((low[..., axis] + corner[axis]) % extinction.shape[axis] for axis in (1, 2))
        total += weight * extinction[k, j, i]
    return total


@pytest.mark.parametrize("interpolated", [False, True])
def test_bricks_hold_what_is_read_in_them(interpolated: bool) -> None:
    rng = np.random.Generator(np.random.PCG64(7))
    extinction = rng.uniform(0.5, 1, (10, 12, 9)).astype(np.float32)
    found = ranges(extinction, 4, "repeat", interpolated)
    assert found.shape == (2, 3, 3, 3)
    points = rng.uniform(0, extinction.shape, (5000, 3))
    values = read(extinction, points, interpolated)
    k, j, i = (points // 4).astype(int).T
    assert (values >= found[0, k, j, i] - 1e-6).all()
    assert (values <= found[1, k, j, i] + 1e-6).all()
    if not interpolated:
        assert found[1, 2, 2, 2] == extinction[8:, 8:, 8:].max()
