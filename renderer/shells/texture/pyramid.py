"""The same matter at coarser and coarser resolutions: three filters.

`thesis_pyramid`: section 5.3.2 of Dufort 2005 after Decaudin and Neyret 2004. Two layers become one by the opacity
formula 5.1 and keep the opacity of twice the length (the reference length doubles at each level, erratum 002-4), then
2 x 2 columns are averaged side by side.
`mean_pyramid`: means of the extinction, right for matter without structure.
`directional_pyramid`: extinctions along each of the three axes (formulas b3). Along u and v matter is composited at the
full resolution across the axis, then averaged side by side, so that a coarse voxel has exactly the mean opacity of
what it stands for, seen along that axis. Along w a coarse voxel takes, of the light which has come through those above
it, exactly the share that the fine voxels take: columns that are opaque above hide what is opaque below.

All levels hold extinctions per reference length of level 0 and sizes of a mipmap: max(1, n // 2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from renderer.shells.texture.extinction import Extinct

Extents = tuple[float, float, float]

LEAST = np.float32(1e-30)
"""Least transmittance of a voxel, so that its logarithm stays a number."""

SEEN = np.float32(1e-6)
"""Share of the light below which a voxel counts as hidden from above."""


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


def extents(shape: tuple[int, ...], size: tuple[float, float, float], height: float = 1.0) -> Extents:
    """Sides of a voxel along u, v, w in reference lengths.

    Args:
        shape: (K, J, I). size: sides of the box in any one unit. height: of a voxel, in reference lengths; 1 for a
            procedure that says nothing else.
    """
    layers, rows, columns = shape[:3]
    per = height * layers / size[2]
    return per * size[0] / columns, per * size[1] / rows, height


def thesis_pyramid(finest: Extinct, voxel: Extents) -> list[Extinct]:
    """Levels by the thesis' filter, the finest first.

    Args:
        finest: level 0. voxel: its voxels' sides in reference lengths.
    """
    levels, height, means = [finest], np.float32(voxel[2]), finest
    while max(levels[-1].matter.shape[:3]) > 1:
        matter = np.ascontiguousarray(levels[-1].matter, np.float32)
        shape = tuple(max(1, length // 2) for length in matter.shape[:3])
        found = np.empty((*shape, 4), np.float32)
        (rows, row_parts), (down, down_parts), (beside, beside_parts) = map(_cells, matter.shape[:3], shape)
        _joined(matter, rows, row_parts, down, down_parts, beside, beside_parts, height, found)
        height *= np.float32(matter.shape[0] / shape[0])
        means = _halved(means)
        levels.append(Extinct(found, _rescaled(means.surface, means.matter[..., 3], found[..., 3])))
    return levels


@numba.njit(cache=True, nogil=True, fastmath=True)
def _joined(matter, rows, row_parts, down, down_parts, beside, beside_parts, height, found):
    """One level of the thesis: voxels of a column one over the other, light coming out at the top; columns averaged.

    Args:
        matter: extinction form. rows, down, beside: `_cells` along w, v and u, each with its parts.
        height: of a voxel, in reference lengths. found: the coarser level, result.
    """
    one = np.float32(1)
    for k in range(len(rows)):
        whole = height * row_parts[k].sum()
        for j in range(len(down)):
            for i in range(len(beside)):
                red = green = blue = passes = weight = np.float32(0)
                for b in range(down.shape[1]):
                    for a in range(beside.shape[1]):
                        share = down_parts[j, b] * beside_parts[i, a]
                        clear = share
                        for s in range(rows.shape[1] - 1, -1, -1):
                            own = matter[rows[k, s], down[j, b], beside[i, a]]
                            if own[3] > 0:
                                left = clear * math.exp(-own[3] * height * row_parts[k, s])
                                taken = (clear - left) / own[3]
                                red += taken * own[0]
                                green += taken * own[1]
                                blue += taken * own[2]
                                clear = left
                        passes += clear
                        weight += share
                passes = passes / weight
                extinction = -math.log(max(passes, LEAST)) / whole
                factor = extinction / (weight * (one - passes)) if passes < one else np.float32(0)
                found[k, j, i, 0], found[k, j, i, 1] = red * factor, green * factor
                found[k, j, i, 2], found[k, j, i, 3] = blue * factor, extinction


def mean_pyramid(finest: Extinct) -> list[Extinct]:
    """Levels by the mean of the extinction, the finest first."""
    levels = [finest]
    while max(levels[-1].matter.shape[:3]) > 1:
        levels.append(_halved(levels[-1]))
    return levels


def _halved(finer: Extinct) -> Extinct:
    matter, surface = finer.matter, finer.surface
    for axis, length in enumerate(finer.matter.shape[:3]):
        matter, surface = (_average(part, axis, max(1, length // 2)) for part in (matter, surface))
    return Extinct(matter, surface)


def directional_pyramid(finest: Extinct, voxel: Extents) -> list[Directional]:
    """Levels by the directional filter, the finest first, which is the same in all directions.

    Args:
        finest: level 0. voxel: its voxels' sides in reference lengths.
    """
    levels = [Directional(np.stack([finest.matter] * 3), finest.surface)]
    # Arrays are [k, j, i]: u is their last axis.
    columns, length = [finest.matter] * 2, list(voxel[:2])
    means, light = finest, _from_above(finest.matter, voxel[2])
    while max(levels[-1].surface.shape[:3]) > 1:
        shape = tuple(max(1, n // 2) for n in levels[-1].surface.shape[:3])
        along = np.empty((3, *shape, 4), np.float32)
        for k, axis in enumerate((2, 1)):
            count = columns[k].shape[axis]
            columns[k] = _in_front(columns[k], axis, length[k])
            length[k] *= count / shape[axis]
            beside = _opaque(columns[k], length[k])
            for across in {0, 1, 2} - {axis}:
                beside = _average(beside, across, shape[across])
            along[k] = _extinct(beside, length[k])
        means = _halved(means)
        light = _average(_average(light, 1, shape[1]), 2, shape[2])
        along[2] = _taken(light, shape[0], voxel[2], means.matter)
        levels.append(
            Directional(along, _rescaled(means.surface, means.matter[..., 3], along[..., 3].mean(axis=0)))
        )
    return levels


def _from_above(matter: np.ndarray, height: float) -> np.ndarray:
    """Colour seen so far, and transmittance, of each column above each boundary of layers, from the top, (K + 1, J, I,
    4)."""
    down = _opaque(matter[::-1], height)
    found = np.zeros((len(down) + 1, *down.shape[1:]), np.float32)
    found[0, ..., 3] = 1
    np.cumprod(down[..., 3], axis=0, out=found[1:, ..., 3])
    np.cumsum(down[..., :3] * found[:-1, ..., 3:], axis=0, out=found[1:, ..., :3])
    return found


def _taken(light: np.ndarray, count: int, height: float, means: np.ndarray) -> np.ndarray:
    """Extinction form (count, J, I, 4) of what takes that light; `means` where none is left.

    Args:
        light: as of `_from_above`. height: of a fine voxel, in reference lengths.
    """
    place = np.linspace(0, len(light) - 1, count + 1)
    low = np.minimum(place.astype(int), len(light) - 2)
    part = (place - low).astype(np.float32)[:, None, None, None]
    at = light[low]
    if part.any():
        # Within a layer light fades exponentially, and its colour comes as it fades.
        first, last = at[..., 3:], light[low + 1][..., 3:]
        left = np.maximum(first, LEAST) ** (1 - part) * np.maximum(last, LEAST) ** part
        gone = np.divide(first - left, first - last, out=np.zeros_like(left), where=first > last)
        at = np.concatenate([at[..., :3] + (light[low + 1] - at)[..., :3] * gone, left], axis=-1)
    before, after = at[:-1, ..., 3], at[1:, ..., 3]
    seen = before > SEEN
    ratio = np.divide(after, before, out=np.ones_like(after), where=seen)
    extinction = -np.log(np.maximum(ratio, LEAST)) / np.float32(height * (len(light) - 1) / count)
    lost = before - after
    factor = np.divide(extinction, lost, out=np.zeros_like(lost), where=seen & (lost > 0))
    found = np.concatenate([(at[1:, ..., :3] - at[:-1, ..., :3]) * factor[..., None], extinction[..., None]], axis=-1)
    return np.where(seen[..., None], found, means[::-1])[::-1]


def _rescaled(surface: np.ndarray, weight: np.ndarray, extinction: np.ndarray) -> np.ndarray:
    factor = np.divide(extinction, weight, out=np.zeros_like(extinction), where=weight > 0)
    scaled: np.ndarray = surface * factor[..., None]
    return scaled


def _cells(length: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Voxels (count, S) of which each coarser one is made, in order, and how much of each (0 to 1)."""
    edges = np.arange(count + 1) * (length / count)
    first = np.floor(edges[:-1] + 1e-9).astype(int)
    slots = int((np.ceil(edges[1:] - 1e-9) - first).max())
    index = first[:, None] + np.arange(slots)
    part = np.minimum(index + 1, edges[1:, None]) - np.maximum(index, edges[:-1, None])
    return np.minimum(index, length - 1), np.clip(part, 0.0, 1.0).astype(np.float32)


def _average(array: np.ndarray, axis: int, count: int) -> np.ndarray:
    """Means of `count` equal runs along an axis."""
    length = array.shape[axis]
    if length == count:
        return array
    if length == 2 * count:
        first, second = (array[(slice(None),) * axis + (slice(slot, None, 2),)] for slot in range(2))
        return (first + second) * np.float32(0.5)
    index, part = _cells(length, count)
    shares = [-1 if n == axis else 1 for n in range(array.ndim)]
    total = sum(array.take(index[:, slot], axis) * part[:, slot].reshape(shares) for slot in range(index.shape[1]))
    mean: np.ndarray = total / np.float32(length / count)
    return mean


def _in_front(matter: np.ndarray, axis: int, length: float) -> np.ndarray:
    """Voxels joined in front of one another along an axis, to half as many; extinction form. The colour is the mean of
    what comes out at either end.

    Args:
        length: of a voxel along the axis, in reference lengths.
    """
    parts = _slots(matter, axis)
    extinction = _average(matter[..., 3], axis, max(1, matter.shape[axis] // 2))
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
    index, part = _cells(length, max(1, length // 2))
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
