"""How much of a sun anywhere in the sky reaches each voxel of the pattern, kept in a few coefficients a voxel."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from renderer.core.technique import Arrays, Bake
from renderer.forest.horizon_textures import sectors_beside
from renderer.forest.pattern_kernels import add_transmittance
from renderer.forest.species_alone import opacities
from renderer.forest.tiles import RHOMBI, lattice
from renderer.forest.world_scale import CANOPY_HEIGHT, TILE_SIDE

AZIMUTHS = 32
"""Directions around, between which the function is interpolated."""

ELEVATIONS = np.radians([2.0, 5.0, 9.0, 14.0, 20.0, 28.0, 38.0, 50.0, 65.0, 85.0])
"""Elevations over the slope [rad] at which it is known."""

OPAQUE = 1 - 2**-12
"""Opacity at which extinction is cut off, as in the pattern."""

LONGEST = 1.5
"""Voxels that one sample of a slanted ray's sum may cross in a layer."""


def extinction_of(opacity: np.ndarray) -> tuple[np.ndarray, float]:
    """Extinction [1/m] float32 of opacities (K, J, I) uint8 over one voxel's length, and that length [m]."""
    voxel = TILE_SIDE * RHOMBI / opacity.shape[2]
    alpha = np.minimum(opacity.astype(np.float32) / np.float32(255), np.float32(OPAQUE))
    return -np.log1p(-alpha) / np.float32(CANOPY_HEIGHT / opacity.shape[0]), voxel


def transmittance(extinction: np.ndarray, voxel: float, azimuth: float, elevation: float) -> np.ndarray:
    """Transmittance from the sky to each voxel's centre along one direction, (K, J, I) float32.

    Args:
        extinction: (K, J, I) [1/m], layer 0 lowest, over the torus of the atlas. voxel: its side [m].
        azimuth, elevation: [rad]; elevation over the slope, for the layers are sheared with the ground.

    Source: formulas h (one prefix sum a column of a grid sheared along the ray).
    """
    layer = CANOPY_HEIGHT / len(extinction)
    flat = layer / math.tan(elevation)
    shift = np.array([math.sin(azimuth) * flat, math.cos(azimuth) * flat]) @ np.linalg.inv(lattice(voxel))
    parts = max(1, math.ceil(float(np.abs(shift).max()) / LONGEST))
    result = np.zeros_like(extinction)
    add_transmittance(extinction, shift, layer / math.sin(elevation), parts, 1.0, np.empty_like(extinction), result)
    return result


def bake_transmittance(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """The sun's transmittance to every voxel from every direction, in its principal components.

    Args:
        arguments: `coefficients`, how many are kept a voxel.
        inputs: `pattern`, with `colour_1`, of twice the voxels' length.

    Returns:
        `coefficients` float32 (S, K, J, I, R) and `basis` float32 (S, AZIMUTHS, ELEVATIONS, R), whose product is the
        transmittance of each of the S sections; `residual` () root mean square of what the components leave out.
        Without a species map there is one section, and no axis of it.

    Source: Sloan, Hall, Hart & Snyder 2003, section 4 (principal components of transferred light), of one cluster.
    The surroundings are the atlas' own; on the map they are others of the same make.
    """
    given, made = opacities(inputs["pattern"], 1), []
    for number, alpha in enumerate(given):
        made.append(
            _components(
                alpha,
                int(arguments["coefficients"]),
                lambda share, words, n=number: progress((n + share) / len(given), words),  # type: ignore[misc]
            )
        )
    if len(made) == 1:
        return made[0]
    found = {name: np.stack([one[name] for one in made]) for name in ("coefficients", "basis")}
    return {**found, "residual": np.sqrt(np.mean([one["residual"] ** 2 for one in made]))}


def _components(alpha: np.ndarray, kept: int, progress: Callable[[float, str], None]) -> dict[str, np.ndarray]:
    """The functions of the voxels of one canopy of opacity (K, J, I) uint8, in their own principal components."""
    extinction, voxel = extinction_of(alpha)
    count = AZIMUTHS * len(ELEVATIONS)
    table = np.empty((count, extinction.size), np.float32)

    def one(number: int) -> None:
        around, up = divmod(number, len(ELEVATIONS))
        found = transmittance(extinction, voxel, 2 * math.pi * around / AZIMUTHS, float(ELEVATIONS[up]))
        table[number] = found.ravel()

    with ThreadPoolExecutor(2) as pool:
        for done, _ in enumerate(pool.map(one, range(count))):
            progress(0.6 * done / count, "letting the sun through the canopy")
    progress(0.6, "finding what the voxels have in common")
    weights, directions = np.linalg.eigh((table @ table.T).astype(np.float64))
    basis = np.ascontiguousarray(directions[:, ::-1][:, :kept], np.float32)
    left = float(np.maximum(weights[: count - kept], 0).sum())
    return {
        "coefficients": (table.T @ basis).reshape(*extinction.shape, kept),
        "basis": basis.reshape(AZIMUTHS, len(ELEVATIONS), kept),
        "residual": np.array(math.sqrt(left / table.size)),
    }


def transmittance_bake(pattern: Bake, coefficients: int) -> Bake:
    """The voxels' transmittance functions."""
    return Bake("transmittance", bake_transmittance, {"coefficients": coefficients}, (pattern,), version=2, seconds=6)


def at_sun(baked: Arrays, azimuth: float, elevations: np.ndarray) -> np.ndarray:
    """Transmittance for one azimuth and several elevations over the slope [rad]: bytes (K, J, I, elevations), the
    sections one above the other."""
    if baked["basis"].ndim == 4:
        each = zip(baked["coefficients"], baked["basis"], strict=True)
        return np.concatenate([at_sun({"coefficients": c, "basis": b}, azimuth, elevations) for c, b in each])
    basis = baked["basis"]
    first, second, part = sectors_beside(azimuth, len(basis))
    share = np.float32(part)
    around = (1 - share) * basis[first] + share * basis[second]
    knots = np.interp(np.clip(elevations, ELEVATIONS[0], ELEVATIONS[-1]), ELEVATIONS, np.arange(len(ELEVATIONS)))
    low = np.minimum(knots.astype(int), len(ELEVATIONS) - 2)
    rest = (knots - low).astype(np.float32)[:, None]
    chosen = (1 - rest) * around[low] + rest * around[low + 1]
    shares = baked["coefficients"] @ (255 * chosen.T)
    np.clip(shares, 0, 255, out=shares)
    found: np.ndarray = np.rint(shares, out=shares).astype(np.uint8)
    return found
