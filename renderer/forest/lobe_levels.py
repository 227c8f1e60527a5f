"""Bakes a Lafortune lobe for every voxel of the pattern and of its coarser levels, averaged or fitted anew.

Cohen 2004, section 6.5, leaves open how lobes are filtered. A coarse voxel's leaves are those of all the finest voxels
inside it, each counting by what an eye outside sees of it. Averaged, a level has the mean of its children's
coefficients; refitted, the lobe about the same mean normal that is nearest to what those leaves send, with the average
as the first guess.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.core.technique import Arrays
from renderer.forest.lobe import LEAST, MOST, coefficients_of, decode, directions, encode, leaves_reflect
from renderer.forest.lobe_kernels import gather, refit
from renderer.forest.pattern_mips import LEVELS
from renderer.forest.tiles import lattice
from renderer.forest.world_scale import VOXEL

Floats = NDArray[np.floating]

FACINGS = 512
"""Directions that leaves are told apart by, 5 degrees from one to the next."""

AGREEMENTS = 5
"""Steps of how far a voxel's leaves agree, from everywhere to all alike."""

STEPS = np.array(
    [(1, 0, 0), (-1, 0, 0)]
    + [(0, j, i) for j, i in ((0, 1), (0, -1), (1, 0), (-1, 0))]
    + [(k, j, i) for k in (1, -1) for j, i in ((1, 1), (1, -1), (-1, 1), (-1, -1))]
)
"""Whole voxels (k, j, i) towards the eyes from which a block is looked at."""

SUNS = 24


def towards(steps: NDArray) -> tuple[Floats, Floats]:
    """Unit vectors (V, 3) along steps of whole voxels, and the steps' lengths in voxels."""
    axes = lattice(VOXEL)
    vectors = np.concatenate([steps[:, 2:] * axes[0] + steps[:, 1:2] * axes[1], steps[:, :1] * VOXEL], axis=1)
    length = np.linalg.norm(vectors, axis=1)
    return vectors / length[:, None], length / VOXEL


def mean_normals(stored: NDArray[np.uint8]) -> tuple[Floats, Floats]:
    """Unit mean normals (.., 3) of bytes, and how far the leaves agree (..)."""
    mean = stored[..., :3].astype(np.float32) / np.float32(127.5) - 1
    length = np.linalg.norm(mean, axis=-1)
    return mean / np.maximum(length, 1e-4)[..., None], np.minimum(length, 1)


def kinds_of(normal: NDArray[np.uint8], full: NDArray[np.bool_]) -> NDArray[np.int32]:
    """Number of each full voxel's kind of leaves: nearest of `FACINGS` directions, nearest of `AGREEMENTS`."""
    known = directions(FACINGS).astype(np.float32)
    result = np.zeros(full.shape, np.int32)
    for layer in range(len(full)):
        way, kappa = mean_normals(normal[layer][full[layer]])
        facing = np.argmax(way @ known.T, axis=1)
        result[layer][full[layer]] = facing * AGREEMENTS + np.rint(kappa * (AGREEMENTS - 1)).astype(np.int64)
    return result


def table_of(eyes: Floats, suns: Floats) -> NDArray[np.float32]:
    """What leaves of each kind reflect towards each eye from each sun, (kinds, V, S)."""
    ways = directions(FACINGS)
    seen, lit = ways @ eyes.T, ways @ suns.T
    cosine = np.clip(eyes @ suns.T, -1, 1)
    rows = [
        leaves_reflect(kappa, lit[:, None, :], seen[:, :, None], cosine[None])
        for kappa in np.linspace(0, 1, AGREEMENTS)
    ]
    return np.stack(rows, axis=1).reshape(FACINGS * AGREEMENTS, len(eyes), len(suns)).astype(np.float32)


def depths(colour: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Optical depth of each voxel's own length."""
    opacity = np.minimum(colour[..., 3].astype(np.float32) / np.float32(255), np.float32(1 - 2**-12))
    return -np.log1p(-opacity)


def averaged(coefficients: Floats, opacity: Floats) -> Floats:
    """The children's mean values (K, J, I, n), weighted by opacity, at half the resolution."""
    k, j, i = (size // 2 for size in opacity.shape)
    weight = (opacity + np.float32(1e-4)).reshape(k, 2, j, 2, i, 2)
    total = (coefficients.reshape(k, 2, j, 2, i, 2, -1) * weight[..., None]).sum(axis=(1, 3, 5))
    result: Floats = total / weight.sum(axis=(1, 3, 5))[..., None]
    return result


def levels_of(baked: Arrays, name: str) -> list[NDArray]:
    """An array's levels, finest first: `name`, `name_1` and on."""
    return [baked[name], *(baked[f"{name}_{n}"] for n in range(1, LEVELS + 1) if f"{name}_{n}" in baked)]


def bake_lobes(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]) -> Arrays:
    """Lobes of every level.

    Args:
        arguments: `levels`: `averaged` or `refitted`. inputs: `pattern`.

    Returns:
        `lobe` and `lobe_1` to `lobe_5`, uint8 [k, j, i, 4]: Cxy, Cz, p and a as `lobe.encode` stores them.
    """
    pattern = inputs["pattern"]
    progress(0.0, "giving voxels their lobes")
    known = encode(coefficients_of(np.linspace(0, 1, 256)))
    _, kappa = mean_normals(pattern["normal"])
    result: dict[str, NDArray] = {"lobe": known[np.rint(kappa * 255).astype(np.int64)]}
    levels = [n for n in range(1, LEVELS + 1) if f"colour_{n}" in pattern]
    mean = decode(result["lobe"]).astype(np.float32)
    opacity = pattern["colour"][..., 3].astype(np.float32) / np.float32(255)
    for level in levels:
        mean = averaged(mean, opacity)
        opacity = pattern[f"colour_{level}"][..., 3].astype(np.float32) / np.float32(255)
        result[f"lobe_{level}"] = encode(mean)
    if arguments["levels"] == "refitted":
        result |= _refitted(pattern, result, levels, progress)
    return result


def _refitted(
    pattern: Arrays, means: Arrays, levels: list[int], progress: Callable[[float, str], None]
) -> dict[str, NDArray]:
    """The coarser levels' lobes, fitted anew."""
    eyes, lengths = towards(STEPS)
    suns = directions(SUNS)
    depth = depths(pattern["colour"])
    kind = kinds_of(pattern["normal"], depth > 0)
    table = table_of(eyes, suns)
    result = {}
    work = [(level, layer) for level in levels for layer in range(len(means[f"lobe_{level}"]))]
    with ThreadPoolExecutor(2) as pool:
        for level in levels:
            normal, _ = mean_normals(pattern[f"normal_{level}"])
            starts = decode(means[f"lobe_{level}"])

            def fitted(layer: int, level: int = level, normal: Floats = normal, starts: Floats = starts) -> Floats:
                shape, side = starts.shape[1:3], 2**level
                total = np.zeros((*shape, len(eyes), len(suns)), np.float32)
                shown = np.zeros((*shape, len(eyes)), np.float32)
                gather(depth, kind, side, layer, STEPS, lengths.astype(np.float32), table, total, shown)
                found = np.empty((*shape, 4))
                refit(total, shown, normal[layer], starts[layer], eyes, suns, LEAST, MOST, found)
                return found

            layers = []
            for layer, found in enumerate(pool.map(fitted, range(len(starts)))):
                layers.append(found)
                progress((work.index((level, layer)) + 1) / len(work), "fitting the coarser levels' lobes")
            result[f"lobe_{level}"] = encode(np.stack(layers))
    return result
