"""Few bytes a voxel: how dense its matter is, and how far a ray may go on in the like of it.

Formulas g, Chebyshev distances. In nothing the first byte falls with the distance to the nearest matter; from `FIRST`
on it counts opacity, whose finer part is the second byte: each may be interpolated by itself. Where some matter is
faint, a third tells how far a ray may go on in it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numba
import numpy as np

from renderer.core.technique import Arrays, Bake
from renderer.shells.texture.occupancy import FARTHEST, distances

FIRST = 96
"""First byte of matter's opacity; those below tell how far it is."""

PER_VOXEL = 4
"""Bytes below `FIRST` that a voxel's distance takes."""

FAINT = 0.06
"""Extinction of a voxel's height below which matter is faint."""

FARTHEST_FAINT = 12
"""Largest distance to other than faint matter that is told apart."""

PER_FAINT = 24
"""Of the third byte, for a voxel that a ray may go on in faint matter."""

DECLARATIONS = f"""uniform sampler3D shell_coded;
const float CODED_FIRST = {float(FIRST)!r};     // as in renderer/shells/texture/strides.py
const float CODED_PER_VOXEL = {float(PER_VOXEL)!r};
const float CODED_FAINT = {float(PER_FAINT)!r};"""


def strides_bake(texture: Bake, wrap: str) -> Bake:
    """The precomputation of distances in a baked texture."""
    return Bake("strides", bake_strides, {"wrap": wrap}, (texture,), version=2, seconds=1)


def bake_strides(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """Distances at a texture's densest moment.

    Args:
        arguments: `wrap`, as of the voxels.
        inputs: `texture`.

    Returns:
        `empty` (K, J, I) uint8, Chebyshev distance to the nearest matter, 0 in it; `faint` (K, J, I) uint8, that to
        other than faint matter, 0 in it.
    """
    progress(0.1, "finding what is empty")
    texture, wrap = inputs["texture"], arguments["wrap"]
    opacity = np.asarray(texture["colour"][..., 3], np.float32)
    thin = opacity < -np.expm1(-FAINT)
    empty = distances(opacity > 0, wrap)
    # Where the reference length is no voxel's height, how faint a voxel is depends on the shell.
    known = float(texture["reference_length"]) == 0
    progress(0.6, "finding what is faint")
    faint = np.minimum(distances(~thin | (opacity == 0), wrap), FARTHEST_FAINT) if known else np.zeros_like(empty)
    return {"empty": np.minimum(empty, FARTHEST), "faint": faint}


def coded(strides: Arrays, levels: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Bytes (K, J, I, 2) of each level, or (K, J, I, 4) where some matter is faint.

    Args:
        strides: as of `bake_strides`. levels: (K, J, I) of each, 0 to 1: what a shader interpolates for the opacity.
    """
    empty, faint, found = np.asarray(strides["empty"]), np.asarray(strides["faint"]), []
    channels = 4 if faint.any() else 2
    for level in levels:
        while empty.shape != level.shape:
            empty, faint = _halved(empty), _halved(faint)
        out = np.zeros((*level.shape, channels), np.uint8)
        _coded(np.ascontiguousarray(level, np.float32), np.ascontiguousarray(empty), np.ascontiguousarray(faint), out)
        found.append(out)
    return found


def _halved(distance: np.ndarray) -> np.ndarray:
    """Distances in voxels twice as wide."""
    halves: np.ndarray = (_blocks(distance) + (_blocks(distance) > 0)) // np.uint8(2)
    return halves


def _blocks(array: np.ndarray) -> np.ndarray:
    """The least of two neighbours along each axis; a last one without a neighbour is left out."""
    for axis in range(3):
        count = array.shape[axis]
        if count > 1:
            pairs = np.moveaxis(array, axis, 0)[: count // 2 * 2]
            array = np.moveaxis(np.minimum(pairs[0::2], pairs[1::2]), 0, axis)
    return array


@numba.njit(cache=True, nogil=True)
def _coded(number, empty, faint, out):
    layers, rows, columns = number.shape
    nearest = FIRST // PER_VOXEL
    for k in range(layers):
        for j in range(rows):
            for i in range(columns):
                there = number[k, j, i]
                if there <= 0:
                    out[k, j, i, 0] = FIRST - PER_VOXEL * (min(max(empty[k, j, i], 1), nearest) - 1)
                    continue
                parts = int(min(there, np.float32(1)) * np.float32((255 - FIRST) * 255) + np.float32(0.5))
                out[k, j, i, 0] = FIRST + parts // 255
                out[k, j, i, 1] = parts % 255
                if faint[k, j, i] > 2:
                    out[k, j, i, 2] = PER_FAINT * (faint[k, j, i] - 2)
