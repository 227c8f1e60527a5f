"""The same matter at coarser and coarser resolutions, by several filters.

`thesis_pyramid`: section 5.3.2 of Dufort 2005 after Decaudin and Neyret 2004. Two layers become one by the opacity
formula 5.1 and keep the opacity of twice the length (the reference length doubles at each level, erratum 002-4), then
2 x 2 columns are averaged side by side.
`mean_pyramid`: means of the extinction, right for matter without structure.
`above_pyramid`: of the light which has come down to it through those above, a coarse voxel takes exactly the share that
its fine voxels take. Columns that are opaque above hide what is opaque below, and what lines up stays lined up.
`directional_pyramid` (directional.py): extinctions along each of the three axes (formulas b3).

All levels hold extinctions per reference length of level 0 and sizes of a mipmap: max(1, n // 2).
"""

from __future__ import annotations

import math

import numba
import numpy as np

from renderer.shells.texture.extinction import Extinct

Extents = tuple[float, float, float]

LEAST = np.float32(1e-30)
"""Least transmittance of a voxel, so that its logarithm stays a number."""

HIDDEN = np.float32(0.01)
"""Share of a voxel that counts as seen though all around it is opaque, so that its normal stays a number."""

SEEN = np.float32(1e-6)
"""Share of the light below which a voxel counts as hidden from above."""


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
    levels, height, faces = [finest], np.float32(voxel[2]), shown(finest)
    while max(levels[-1].matter.shape[:3]) > 1:
        matter = np.ascontiguousarray(levels[-1].matter, np.float32)
        shape = tuple(max(1, length // 2) for length in matter.shape[:3])
        found = np.empty((*shape, 4), np.float32)
        (rows, row_parts), (down, down_parts), (beside, beside_parts) = map(cells, matter.shape[:3], shape)
        _joined(matter, rows, row_parts, down, down_parts, beside, beside_parts, height, found)
        height *= np.float32(matter.shape[0] / shape[0])
        faces = halved(faces)
        levels.append(Extinct(found, rescaled(faces.surface, faces.matter[..., 0], found[..., 3])))
    return levels


@numba.njit(cache=True, nogil=True, fastmath=True)
def _joined(matter, rows, row_parts, down, down_parts, beside, beside_parts, height, found):
    """One level of the thesis: voxels of a column one over the other, light coming out at the top; columns averaged.

    Args:
        matter: extinction form. rows, down, beside: `cells` along w, v and u, each with its parts.
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
        levels.append(halved(levels[-1]))
    return levels


def halved(finer: Extinct) -> Extinct:
    """The next level of the means of extinction."""
    matter, surface = finer.matter, finer.surface
    for axis, length in enumerate(finer.matter.shape[:3]):
        matter, surface = (averaged(part, axis, max(1, length // 2)) for part in (matter, surface))
    return Extinct(matter, surface)


def above_pyramid(finest: Extinct, voxel: Extents) -> list[Extinct]:
    """Levels by the light from above, the finest first: of what has come down to it, a coarse voxel takes the share
    that its fine voxels take.

    Args:
        finest: level 0. voxel: its voxels' sides in reference lengths.
    """
    levels, means, light = [finest], finest, np.empty(0, np.float32)
    faces = shown(finest)
    while max(levels[-1].matter.shape[:3]) > 1:
        shape = tuple(max(1, length // 2) for length in levels[-1].matter.shape[:3])
        if len(levels) == 1:
            light = np.zeros((len(finest.matter) + 1, shape[1], shape[2], 4), np.float32)
            across = (*cells(finest.matter.shape[1], shape[1]), *cells(finest.matter.shape[2], shape[2]))
            _from_above(np.ascontiguousarray(finest.matter, np.float32), *across, np.float32(voxel[2]), light)
        else:
            light = averaged(averaged(light, 1, shape[1]), 2, shape[2])
        means, faces = halved(means), halved(faces)
        found = _taken(light, shape[0], voxel[2], means.matter)
        levels.append(Extinct(found, rescaled(faces.surface, faces.matter[..., 0], found[..., 3])))
    return levels


@numba.njit(cache=True, nogil=True, fastmath=True)
def _from_above(matter, down, down_parts, beside, beside_parts, height, light):
    """Colour seen so far and transmittance above each boundary of layers, from the top, means of coarse columns.

    Args:
        matter: extinction form. down, beside: `cells` along v and u, each with its parts. height: of a voxel, in
        reference lengths. light: (K + 1, J', I', 4) of zeros, result.
    """
    layers = len(matter)
    for j in range(len(down)):
        for i in range(len(beside)):
            weight = down_parts[j].sum() * beside_parts[i].sum()
            for b in range(down.shape[1]):
                for a in range(beside.shape[1]):
                    clear = down_parts[j, b] * beside_parts[i, a] / weight
                    red = green = blue = np.float32(0)
                    light[0, j, i, 3] += clear
                    for k in range(layers):
                        own = matter[layers - 1 - k, down[j, b], beside[i, a]]
                        if own[3] > 0:
                            left = clear * math.exp(-own[3] * height)
                            taken = (clear - left) / own[3]
                            red += taken * own[0]
                            green += taken * own[1]
                            blue += taken * own[2]
                            clear = left
                        light[k + 1, j, i, 0] += red
                        light[k + 1, j, i, 1] += green
                        light[k + 1, j, i, 2] += blue
                        light[k + 1, j, i, 3] += clear


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


def shown(finest: Extinct) -> Extinct:
    """Surfaces weighted by how much of their voxels is seen: by its opacity, and by what its six neighbours let through
    on the average. What lies within opaque matter has no part in the normals of coarser levels.

    Returns:
        the weights in place of the extinction, the colours left out.
    """
    extinction = np.ascontiguousarray(finest.matter[..., 3], np.float32)
    found = Extinct(np.zeros((*extinction.shape, 1), np.float32), np.empty_like(finest.surface))
    passes = np.exp(-extinction)
    _shown(extinction, passes, np.ascontiguousarray(finest.surface, np.float32), found.matter, found.surface)
    return found


@numba.njit(cache=True, nogil=True, fastmath=True)
def _shown(extinction, passes, surface, weights, found):
    layers, rows, columns = extinction.shape
    for k in range(layers):
        for j in range(rows):
            for i in range(columns):
                own = extinction[k, j, i]
                weight = np.float32(0)
                if own > 0:
                    # Above is the open air, below is a surface that shows nothing.
                    clear = passes[k + 1, j, i] if k + 1 < layers else np.float32(1)
                    clear += passes[k - 1, j, i] if k > 0 else np.float32(0)
                    clear += passes[k, j - 1, i] + passes[k, (j + 1) % rows, i]
                    clear += passes[k, j, i - 1] + passes[k, j, (i + 1) % columns]
                    weight = (np.float32(1) - passes[k, j, i]) * (clear + HIDDEN)
                weights[k, j, i, 0] = weight
                factor = weight / own if own > 0 else np.float32(0)
                for n in range(4):
                    found[k, j, i, n] = factor * surface[k, j, i, n]


def rescaled(surface: np.ndarray, weight: np.ndarray, extinction: np.ndarray) -> np.ndarray:
    """Surfaces (K, J, I, 4) that are weighted by one extinction (K, J, I), weighted by another."""
    factor = np.divide(extinction, weight, out=np.zeros_like(extinction), where=weight > 0)
    scaled: np.ndarray = surface * factor[..., None]
    return scaled


def cells(length: int, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Voxels (count, S) of which each coarser one is made, in order, and how much of each (0 to 1)."""
    edges = np.arange(count + 1) * (length / count)
    first = np.floor(edges[:-1] + 1e-9).astype(int)
    slots = int((np.ceil(edges[1:] - 1e-9) - first).max())
    index = first[:, None] + np.arange(slots)
    part = np.minimum(index + 1, edges[1:, None]) - np.maximum(index, edges[:-1, None])
    return np.minimum(index, length - 1), np.clip(part, 0.0, 1.0).astype(np.float32)


def averaged(array: np.ndarray, axis: int, count: int) -> np.ndarray:
    """Means of `count` equal runs along an axis."""
    length = array.shape[axis]
    if length == count:
        return array
    if length == 2 * count:
        first, second = (array[(slice(None),) * axis + (slice(slot, None, 2),)] for slot in range(2))
        return (first + second) * np.float32(0.5)
    index, part = cells(length, count)
    shares = [-1 if n == axis else 1 for n in range(array.ndim)]
    total = sum(array.take(index[:, slot], axis) * part[:, slot].reshape(shares) for slot in range(index.shape[1]))
    mean: np.ndarray = total / np.float32(length / count)
    return mean


