"""Coarser levels whose extinction depends on the direction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.shells.texture.extinction import Extinct
from renderer.shells.texture.pyramid import (
    LEAST,
    Extents,
    above_pyramid,
    averaged,
    cells,
    halved,
    rescaled,
    shown,
)


@dataclass(frozen=True)
class Directional:
    """A level whose extinction depends on the direction.

    Attributes:
        along: (3, K, J, I, 4) float32, extinction times colour and extinction along u, v, w, per reference length. The
            colours along u and v are means of both directions; along w that of light which comes out at the top.
        surface: as in `Extinct`, with the mean of the three extinctions.
    """

    along: np.ndarray
    surface: np.ndarray

    def towards(self, direction: np.ndarray) -> np.ndarray:
        """Extinction form (K, J, I, 4) for rays along a unit direction in the frame of the box.

        The extinction is that of an ellipsoid, whose projected area is sqrt(sum of d_k^2 s_k^2) (Heitz, Dupuy, Crassin
        and Dachsbacher 2015, equation 2): exact for fog and for sheets across an axis, where the blend d_k^2 s_k of
        formulas b3 is too clear for a sheet seen askew.
        """
        weight = np.square(np.asarray(direction, np.float32))
        squared = np.tensordot(weight, np.square(self.along[..., 3]), axes=1)
        blended: np.ndarray = np.tensordot(weight, self.along, axes=1)
        factor = np.divide(np.sqrt(squared), blended[..., 3], out=np.zeros_like(squared), where=blended[..., 3] > 0)
        return blended * factor[..., None]


def directional_pyramid(finest: Extinct, voxel: Extents) -> list[Directional]:
    """Levels by the directional filter, the finest first, which is the same in all directions.

    Args:
        finest: level 0. voxel: its voxels' sides in reference lengths.
    """
    levels = [Directional(np.stack([finest.matter] * 3), finest.surface)]
    # Arrays are [k, j, i]: u is their last axis.
    columns, length = [finest.matter] * 2, list(voxel[:2])
    faces = shown(finest)
    for above in above_pyramid(finest, voxel)[1:]:
        shape = above.matter.shape[:3]
        along = np.empty((3, *shape, 4), np.float32)
        for k, axis in enumerate((2, 1)):
            count = columns[k].shape[axis]
            columns[k] = _in_front(columns[k], axis, length[k])
            length[k] *= count / shape[axis]
            beside = _opaque(columns[k], length[k])
            for across in {0, 1, 2} - {axis}:
                beside = averaged(beside, across, shape[across])
            along[k] = _extinct(beside, length[k])
        faces = halved(faces)
        along[2] = above.matter
        levels.append(
            Directional(along, rescaled(faces.surface, faces.matter[..., 0], along[..., 3].mean(axis=0)))
        )
    return levels


def _in_front(matter: np.ndarray, axis: int, length: float) -> np.ndarray:
    """Voxels joined in front of one another along an axis, to half as many; extinction form. The colour is the mean of
    what comes out at either end.

    Args:
        length: of a voxel along the axis, in reference lengths.
    """
    parts = _slots(matter, axis)
    extinction = averaged(matter[..., 3], axis, max(1, matter.shape[axis] // 2))
    seen = np.zeros((*extinction.shape, 3), np.float32)
    for order in (parts, parts[::-1]):
        clear = np.ones_like(extinction)
        for own, share in order:
            passes = np.exp(own[..., 3] * (-np.float32(length) * share))
            taken = np.divide(clear * (1 - passes), own[..., 3], out=np.zeros_like(passes), where=own[..., 3] > 0)
            seen += own[..., :3] * taken[..., None]
            clear *= passes
    opacity = 2 * (1 - clear)
    factor = np.divide(extinction, opacity, out=np.zeros_like(opacity), where=opacity > 0)
    found = np.empty((*extinction.shape, 4), np.float32)
    np.multiply(seen, factor[..., None], out=found[..., :3])
    found[..., 3] = extinction
    return found


def _slots(matter: np.ndarray, axis: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """The voxels that become one, in order along an axis, and how much of each (0 to 1)."""
    length = matter.shape[axis]
    if length % 2 == 0:
        one = np.ones((), np.float32)
        return [(matter[(slice(None),) * axis + (slice(slot, None, 2),)], one) for slot in range(2)]
    index, part = cells(length, max(1, length // 2))
    shares = [-1 if n == axis else 1 for n in range(3)]
    return [(matter.take(index[:, slot], axis), part[:, slot].reshape(shares)) for slot in range(index.shape[1])]


def _opaque(matter: np.ndarray, length: float) -> np.ndarray:
    """Colour times opacity, and transmittance, of a length [reference lengths] of matter in extinction form."""
    passes = np.exp(matter[..., 3] * -np.float32(length))
    factor = np.divide(1 - passes, matter[..., 3], out=np.zeros_like(passes), where=matter[..., 3] > 0)
    found = np.empty_like(matter)
    np.multiply(matter[..., :3], factor[..., None], out=found[..., :3])
    found[..., 3] = passes
    return found


def _extinct(opaque: np.ndarray, length: float) -> np.ndarray:
    """The inverse of `_opaque`."""
    passes = opaque[..., 3]
    extinction = np.log(np.maximum(passes, LEAST)) * np.float32(-1 / length)
    factor = np.divide(extinction, 1 - passes, out=np.zeros_like(extinction), where=passes < 1)
    found = np.empty_like(opaque)
    np.multiply(opaque[..., :3], factor[..., None], out=found[..., :3])
    found[..., 3] = extinction
    return found
