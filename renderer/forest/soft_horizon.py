"""Soft horizons of the canopy: at what elevation the sun comes out of the leaves, and over how wide a range."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from os import cpu_count
from typing import Any

import numpy as np
from numba import njit

from renderer.core.technique import Arrays
from renderer.forest.species_alone import each_section, opacities
from renderer.forest.tiles import RHOMBI, lattice
from renderer.forest.world_scale import CANOPY_HEIGHT, TILE_SIDE, VOXEL

ELEVATIONS = np.radians([4.0, 9.0, 15.0, 22.0, 31.0, 42.0, 56.0, 75.0])
"""Elevations looked at [rad]: closer together where the sun's shadows are long."""

REACH = 2.0
"""Voxels that a ray may pass across between two samples."""

AIR = 0.01
"""Extinction [1/m] that stands for air in the weights of a probe, which asks for light where matter is."""

GAMMA_RANGE = math.radians(-30.0), math.radians(90.0)
"""Horizons that a byte tells apart [rad]."""

SPREAD_RANGE = math.radians(1.0), math.radians(61.0)
"""Half penumbras that a byte tells apart [rad]."""

GAMMAS = np.radians(np.arange(-30.0, 91.0, 5.0))
SPREADS = np.radians([1.0, 4.0, 8.0, 13.0, 19.0, 26.0, 35.0, 46.0, 60.0])
"""Horizons and half penumbras tried by the fit [rad]."""

CALM = 0.02
"""What a candidate far from the usual costs, in squared shares of light: where several fit alike, neighbours should
agree, for what is stored is interpolated."""


@njit(cache=True, nogil=True)
def _gather(source, di, dj, scale, result):
    """Add `scale` times a periodic image, moved by a fraction of a voxel, to `result`; (J, I) float32."""
    rows, columns = source.shape
    low_i, low_j = math.floor(di), math.floor(dj)
    fi, fj = np.float32(di - low_i), np.float32(dj - low_j)
    row = np.empty(columns + 1, np.float32)
    begin = low_i % columns
    for j in range(rows):
        a, b = source[(j + low_j) % rows], source[(j + low_j + 1) % rows]
        for i in range(columns):
            row[i] = scale * (a[i] + fj * (b[i] - a[i]))
        row[columns] = row[0]
        for i in range(columns - begin):
            result[j, i] += row[i + begin] + fi * (row[i + begin + 1] - row[i + begin])
        for i in range(columns - begin, columns):
            c = i + begin - columns
            result[j, i] += row[c] + fi * (row[c + 1] - row[c])


@njit(cache=True, nogil=True)
def gather_light(extinction, shift, path, parts, weights, depths, shares):
    """Light from one direction at every probe, averaged over the layers near it.

    In a frame sheared along the direction every ray is a column: the depth of all layers is one running sum.

    Args:
        extinction: (K, J, I) [1/m], float32, periodic in J and I. shift: (2,) voxels (i, j) gained a layer upwards.
        path: length [m] inside a layer. parts: samples a layer. weights: (L, K, J, I), of the layers in a probe.
        depths: scratch like `extinction`. shares: (L, J, I) float32, result.

    Source: formulas h (prefix sums in a sheared grid).
    """
    layers, rows, columns = extinction.shape
    above = np.zeros((rows, columns), np.float32)
    layer = np.empty((rows, columns), np.float32)
    for k in range(layers - 1, -1, -1):
        layer[:] = 0
        for part in range(parts):
            place = k + (part + 0.5) / parts - 0.5
            _gather(extinction[k], place * shift[0], place * shift[1], np.float32(path / parts), layer)
        for j in range(rows):
            for i in range(columns):
                depths[k, j, i] = above[j, i] + np.float32(0.5) * layer[j, i]
                above[j, i] += layer[j, i]
    shares[:] = 0
    for k in range(layers):
        layer[:] = 0
        _gather(depths[k], -k * shift[0], -k * shift[1], np.float32(1.0), layer)
        for j in range(rows):
            for i in range(columns):
                lit = np.exp(-layer[j, i])
                for level in range(len(weights)):
                    shares[level, j, i] += weights[level, k, j, i] * lit


def candidates(elevations: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Every pair of a horizon and a half penumbra that the fit tries.

    Args:
        elevations: (E,) [rad].

    Returns:
        pairs (C, 2) [rad]; their smoothsteps (E, C) float32; and what each costs beside its error, (C,) float32.
    """
    pairs = np.stack(np.meshgrid(GAMMAS, SPREADS, indexing="ij"), axis=-1).reshape(-1, 2)
    gamma, spread = pairs.T
    t = np.clip((elevations[:, None] - gamma + spread) / (2 * spread), 0, 1)
    calm = CALM * (((gamma - 0.4) / 1.0) ** 2 + ((spread - 0.3) / 0.6) ** 2)
    return pairs, (t * t * (3 - 2 * t)).astype(np.float32), calm.astype(np.float32)


@njit(cache=True, nogil=True)
def fit(shares, steps, calm, chosen, clear):
    """Fit `clear * smoothstep` to the light of every probe, in the least squares, by trying all candidates.

    Args:
        shares: (E, N) float32 in [0, 1]. steps: (E, C). calm: (C,). chosen: (N,) result, number of the candidate.
        clear: (N,) float32 result, share of the sun that passes above the horizon.
    """
    count = steps.shape[1]
    squares, products = np.zeros(count, np.float32), np.empty(count, np.float32)
    for e in range(len(steps)):
        squares += steps[e] * steps[e]
    squares += np.float32(1e-6)
    for n in range(shares.shape[1]):
        products[:] = 0
        for e in range(len(steps)):
            share, row = shares[e, n], steps[e]
            for c in range(count):
                products[c] += share * row[c]
        for c in range(count):
            passes = min(products[c] / squares[c], np.float32(1.0))
            products[c] = passes * (passes * squares[c] - np.float32(2.0) * products[c]) + calm[c]
        best = np.argmin(products)
        chosen[n] = best
        dot = np.float32(0.0)
        for e in range(len(steps)):
            dot += shares[e, n] * steps[e, best]
        clear[n] = min(dot / squares[best], np.float32(1.0))


def probe_weights(extinction: np.ndarray, heights: np.ndarray) -> np.ndarray:
    """What each layer counts in each probe, (L, K, J, I) float32, summing to 1 over the layers.

    A probe stands for the matter up to its neighbours, less with the distance: for what interpolation between heights
    will ask of it. The lowest, at the ground, is the lowest layer alone.
    """
    layers = len(extinction)
    place = (np.arange(layers) + 0.5) / layers
    near = np.stack([np.interp(place, heights, row) for row in np.eye(len(heights))]).astype(np.float32)
    near[0] = np.arange(layers) == 0
    weights: np.ndarray = near[:, :, None, None] * (extinction + np.float32(AIR))
    return weights / weights.sum(axis=1, keepdims=True)


def bake_soft_horizon(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """Soft horizons of the pattern, by azimuth and height.

    Args:
        arguments: `sectors`, azimuths. `heights`, of the probes, as shares of the canopy's, ascending.
        inputs: `pattern`, with `colour`.

    Returns:
        `soft`, uint8 [chi, heights, J, I, 3]: horizon and half penumbra as shares of `GAMMA_RANGE` and `SPREAD_RANGE`,
        and the share of the sun that passes above. From the sheared horizontal (along the ground); sector m looks along
        WORLD azimuth 2 pi m / chi from north. The neighbours are those of the atlas; on the map they are others of the
        same make. Of several sections, the heights of one after those of the other.
    """
    sectors, levels = int(arguments["sectors"]), np.array(arguments["heights"], float)

    def one(alpha: np.ndarray, tell: Callable[[float], None]) -> np.ndarray:
        return np.moveaxis(_soft(alpha, sectors, levels, tell), 1, 0)

    words = "looking out of the canopy"
    found = each_section(opacities(inputs["pattern"]), one, lambda share: progress(share, words))
    return {"soft": np.ascontiguousarray(np.moveaxis(found, 0, 1))}


def _soft(opacity: np.ndarray, sectors: int, levels: np.ndarray, progress: Callable[[float], None]) -> np.ndarray:
    """The soft horizons [chi, heights, J, I, 3] of a canopy of opacity (K, J, I) uint8."""
    alpha = np.minimum(opacity / np.float32(255), np.float32(1 - 2**-12))
    voxel = TILE_SIDE * RHOMBI / alpha.shape[2]
    extinction = (-np.log1p(-alpha) / np.float32(VOXEL)).astype(np.float32)
    layer = CANOPY_HEIGHT / len(extinction)
    to_index = np.linalg.inv(lattice(voxel))
    weights = probe_weights(extinction, levels)
    result = np.empty((sectors, *weights.shape[:1], *extinction.shape[1:], 3), np.uint8)
    pairs, steps, calm = candidates(ELEVATIONS)
    lows, highs = np.array([GAMMA_RANGE, SPREAD_RANGE]).T
    bytes_of = np.rint((pairs - lows) * (255 / (highs - lows))).astype(np.uint8)

    def one(sector: int) -> None:
        azimuth = 2 * math.pi * sector / sectors
        shares = np.empty((len(ELEVATIONS), *result.shape[1:4]), np.float32)
        depths = np.empty_like(extinction)
        for elevation, seen in zip(ELEVATIONS, shares, strict=True):
            run = layer / math.tan(elevation)
            shift = np.array([math.sin(azimuth), math.cos(azimuth)]) * run @ to_index
            parts = max(1, math.ceil(np.abs(shift).max() / REACH))
            gather_light(extinction, shift, layer / math.sin(elevation), parts, weights, depths, seen)
        chosen, clear = np.empty(shares[0].size, np.int32), np.empty(shares[0].size, np.float32)
        fit(shares.reshape(len(shares), -1), steps, calm, chosen, clear)
        result[sector, ..., :2] = bytes_of[chosen].reshape(*result.shape[1:4], 2)
        result[sector, ..., 2] = np.rint(255 * clear).reshape(result.shape[1:4])

    with ThreadPoolExecutor(cpu_count()) as pool:
        for done, _ in enumerate(pool.map(one, range(sectors))):
            progress(done / sectors)
    return result
