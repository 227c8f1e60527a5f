"""Coarser levels whose extinction depends on the direction.

Formulas b3: of an opaque column a coarse voxel shows its end or its side, so one number cannot tell how much it hides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from renderer.shells.texture.extinction import Extinct
from renderer.shells.texture.pyramid import LEAST, Extents, above_pyramid, averaged, cells


@dataclass(frozen=True)
class Directional:
    """A level whose extinction depends on the direction.

    Attributes:
        level: by the light from above: its extinction is that along w.
        beside: (K, J, I, 2) float32, extinctions along u and v, per reference length.
    """

    level: Extinct
    beside: np.ndarray

    def towards(self, direction: np.ndarray) -> np.ndarray:
        """Extinction form (K, J, I, 4) for rays along a unit direction in the frame of the box.

        The extinction is that of an ellipsoid, whose projected area is sqrt(sum of d_k^2 s_k^2) (Heitz, Dupuy, Crassin
        and Dachsbacher 2015, equation 2): exact for fog and for sheets across an axis, where the blend d_k^2 s_k of
        formulas b3 is too clear for a sheet seen askew.
        """
        weight = np.square(np.asarray(direction, np.float32))
        own = self.level.matter[..., 3]
        squared = np.square(self.beside) @ weight[:2] + weight[2] * np.square(own)
        factor = np.divide(np.sqrt(squared), own, out=np.zeros_like(squared), where=own > 0)
        found: np.ndarray = self.level.matter * factor[..., None]
        found[..., 3] = np.sqrt(squared)
        return found


def directional_pyramid(finest: Extinct, voxel: Extents) -> list[Directional]:
    """Levels by the directional filter, the finest first, which is the same in all directions.

    Args:
        finest: level 0. voxel: its voxels' sides in reference lengths.
    """
    own = np.ascontiguousarray(finest.matter[..., 3], np.float32)
    levels = [Directional(finest, np.stack([own, own], axis=-1))]
    # Arrays are [k, j, i]: u is their last axis.
    columns, length = [own, own], list(voxel[:2])
    for above in above_pyramid(finest, voxel)[1:]:
        shape = above.matter.shape[:3]
        beside = np.empty((*shape, 2), np.float32)
        for which, axis in enumerate((2, 1)):
            length[which] *= columns[which].shape[axis] / shape[axis]
            columns[which] = np.ascontiguousarray(averaged(columns[which], axis, shape[axis]))
            rows, down, across = (cells(old, new) for old, new in zip(columns[which].shape, shape, strict=True))
            _hidden(columns[which], *rows, *down, *across, np.float32(length[which]), beside[..., which])
        levels.append(Directional(above, beside))
    return levels


@numba.njit(cache=True, nogil=True, fastmath=True)
def _hidden(columns, rows, row_parts, down, down_parts, beside, beside_parts, length, found):
    """Extinction of what hides as much as columns side by side do on the average.

    Args:
        columns: (K, J, I) extinction along one axis, along which they are as long as a coarse voxel.
        length: of that [reference lengths]. rows, down, beside: `cells` along w, v and u, each with its parts.
        found: (K', J', I'), result.
    """
    passes = np.exp(columns * -length)
    for k in range(len(rows)):
        for j in range(len(down)):
            for i in range(len(beside)):
                total = weight = np.float32(0)
                for s in range(rows.shape[1]):
                    for b in range(down.shape[1]):
                        part = row_parts[k, s] * down_parts[j, b]
                        for a in range(beside.shape[1]):
                            total += part * beside_parts[i, a] * passes[rows[k, s], down[j, b], beside[i, a]]
                            weight += part * beside_parts[i, a]
                found[k, j, i] = -math.log(max(total / weight, LEAST)) / length
