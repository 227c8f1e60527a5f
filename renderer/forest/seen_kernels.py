"""Compiled inner loop of the levels as the eye meets them: one direction's light in every voxel, and what stops it."""

from __future__ import annotations

import numpy as np
from numba import njit

from renderer.forest.pattern_kernels import gather


@njit(cache=True, nogil=True)
def follow_light(extinction, shift, path, parts, light, stopped):
    """Add one direction's transmittance from the sky in every voxel, and what of it the voxel stops.

    The sum runs in a frame sheared along the direction, where every ray is a column. Inside a part of a layer light
    falls as Beer and Lambert say: its mean is what is stopped over the optical depth.

    Args:
        extinction: (K, J, I) [1/m], periodic in J and I. shift: (2,) voxels (i, j) gained a layer upwards.
        path: length [m] inside a layer. parts: samples a layer. light, stopped: (K, J, I), in place.

    Source: formulas h (transmittance by prefix sums in a sheared grid).
    """
    layers, rows, columns = extinction.shape
    reaching = np.ones((rows, columns), np.float32)
    depth, passed, kept = np.empty_like(reaching), np.empty_like(reaching), np.empty_like(reaching)
    share = np.float32(1.0 / parts)
    for k in range(layers - 1, -1, -1):
        for part in range(parts - 1, -1, -1):
            place = k + (part + 0.5) / parts - 0.5
            depth[:] = 0.0
            gather(extinction[k], place * shift[0], place * shift[1], np.float32(path / parts), depth)
            for j in range(rows):
                for i in range(columns):
                    kept[j, i] = -reaching[j, i] * np.expm1(-depth[j, i])
                    passed[j, i] = kept[j, i] / depth[j, i] if depth[j, i] > 1e-6 else reaching[j, i]
                    reaching[j, i] -= kept[j, i]
            gather(passed, -place * shift[0], -place * shift[1], share, light[k])
            gather(kept, -place * shift[0], -place * shift[1], np.float32(1.0), stopped[k])
