"""A byte a voxel: how dense its matter is, and how far a ray may go on in the like of it.

Formulas g, Chebyshev distances. In nothing the byte is the distance to the nearest matter; elsewhere it holds the
square root of the extinction, in finer steps where all voxels around are faint, so that a ray may take longer steps.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numba
import numpy as np

from renderer.core.technique import Arrays, Bake
from renderer.shells.texture.block import CLAMP
from renderer.shells.texture.occupancy import FARTHEST, distances

DENSEST = float(-np.log(CLAMP))
"""Extinction of a reference length that the greatest byte stands for."""

FAINT = 0.06
"""Extinction of a voxel's height below which matter is faint."""

STRIDE = 6
"""Distance to other than faint matter from which a faint voxel counts as being among its like."""

FIRST_FAINT, FIRST_OTHER = 32, 96
"""Bytes from which on matter is faint, and from which on it is not."""

_FAINT_STEP = float(np.sqrt(FAINT / DENSEST)) / (FIRST_OTHER - 1 - FIRST_FAINT)
_STEP = 1.0 / (255 - FIRST_OTHER)

DECLARATIONS = f"""const float STRIDE_DENSEST = {DENSEST!r}; // extinction of a reference length at the greatest byte
const float STRIDE_FAINT = {(FIRST_FAINT - 0.5) / 255!r};  // faint matter from there, other from the next
const float STRIDE_OTHER = {(FIRST_OTHER - 0.5) / 255!r};
const float STRIDE_OF_FAINT = {float(STRIDE)!r};           // voxels
const vec2 STRIDE_FAINT_CODING = vec2({255 * _FAINT_STEP!r}, {FIRST_FAINT * _FAINT_STEP!r});
const vec2 STRIDE_CODING = vec2({255 * _STEP!r}, {FIRST_OTHER * _STEP!r});"""


def strides_bake(texture: Bake, wrap: str) -> Bake:
    """The precomputation of distances in a baked texture."""
    return Bake("strides", bake_strides, {"wrap": wrap}, (texture,), seconds=1)


def bake_strides(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """Distances at a texture's densest moment.

    Args:
        arguments: `wrap`, as of the voxels.
        inputs: `texture`.

    Returns:
        `empty` (K, J, I) uint8, Chebyshev distance to the nearest matter, 0 in it; `faint` (K, J, I) bool, whether all
        voxels nearer than `STRIDE` are faint.
    """
    progress(0.1, "finding what is empty")
    texture, wrap = inputs["texture"], arguments["wrap"]
    opacity = np.asarray(texture["colour"][..., 3], np.float32)
    thin = opacity < -np.expm1(-FAINT)
    empty = distances(opacity > 0, wrap)
    # Where the reference length is no voxel's height, how faint a voxel is depends on the shell.
    known = float(texture["reference_length"]) == 0
    progress(0.6, "finding what is faint")
    faint = known & (distances(~thin | (opacity == 0), wrap) >= STRIDE)
    return {"empty": np.minimum(empty, FARTHEST), "faint": np.broadcast_to(faint, opacity.shape).copy()}


def coded(strides: Arrays, levels: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Bytes (K, J, I) of each level.

    Args:
        strides: as of `bake_strides`. levels: (K, J, I, 4) of each, whose last is the extinction of a reference length.
    """
    empty, faint, found = np.asarray(strides["empty"]), np.asarray(strides["faint"]), []
    for level in levels:
        while empty.shape != level.shape[:3]:
            empty, faint = (_blocks(empty) + np.uint8(1)) // np.uint8(2), _blocks(faint)
        out = np.empty(level.shape[:3], np.uint8)
        _coded(np.ascontiguousarray(level[..., 3]), np.ascontiguousarray(empty), np.ascontiguousarray(faint), out)
        found.append(out)
    return found


def _blocks(array: np.ndarray) -> np.ndarray:
    """The least of two neighbours along each axis; a last one without a neighbour is left out."""
    for axis in range(3):
        count = array.shape[axis]
        if count > 1:
            pairs = np.moveaxis(array, axis, 0)[: count // 2 * 2]
            array = np.moveaxis(np.minimum(pairs[0::2], pairs[1::2]), 0, axis)
    return array


@numba.njit(cache=True, nogil=True)
def _coded(extinction, empty, faint, out):
    layers, rows, columns = extinction.shape
    n = 0
    for k in range(layers):
        for j in range(rows):
            for i in range(columns):
                # As in `extinction.bytes_of`: up or down by a chance that is the same each time, right in the mean.
                turn = np.uint32(np.uint32(n) * np.uint32(2654435769)) >> np.uint32(8)
                chance = np.float32(turn) * np.float32(2.0**-24)
                n += 1
                there = extinction[k, j, i]
                if there <= 0:
                    out[k, j, i] = max(empty[k, j, i], 1)
                    continue
                thin = faint[k, j, i] and there < np.float32(FAINT)
                step = np.float32(_FAINT_STEP) if thin else np.float32(_STEP)
                first, last = (FIRST_FAINT, FIRST_OTHER - 1) if thin else (FIRST_OTHER, 255)
                low = np.floor(np.sqrt(min(there / np.float32(DENSEST), np.float32(1))) / step)
                # The mean of the squares of two neighbours, not of their roots, is to be right.
                share = (there / np.float32(DENSEST) / (step * step) - low * low) / (2 * low + 1)
                out[k, j, i] = min(first + int(low) + (1 if chance < share else 0), last)
