"""Compiled inner loops of the pattern: laying one tree into the atlas, and extending normals and feet into the air
around matter."""

from __future__ import annotations

import numpy as np
from numba import njit

ANCHOR_STEPS = 16.0
"""Steps a metre of the stored offset to a tree's foot."""


@njit(cache=True, nogil=True)
def lay(
    mask,
    area,
    normal,
    sums,
    corner,
    foot,
    rank,
    axes,
    shifts,
    atlas_mask,
    atlas_normal,
    atlas_sums,
    atlas_area,
    atlas_most,
    atlas_anchor,
):
    """Add one voxelised tree to the atlas, at every rhombus where it stands.

    Args:
        mask, area, normal, sums: see `Voxels`, [.., k, j, i]. corner: (2,) voxel (i, j) of their corner, from that
        of the rhombus.
        foot: (2,) [m] from the corner of the rhombus. rank: of the tree.
        axes: (2, 2) sides of a voxel [m] along i and j.
        shifts: (S, 2) voxel (i, j) of the rhombi. atlas_*: results; `atlas_most` is the largest area that one tree
        has in the voxel.
    """
    rows, columns = atlas_area.shape[1], atlas_area.shape[2]
    for k in range(area.shape[0]):
        for j in range(area.shape[1]):
            for i in range(area.shape[2]):
                if area[k, j, i] == 0.0:
                    continue
                u, v = corner[0] + i + 0.5, corner[1] + j + 0.5
                east = np.round((foot[0] - u * axes[0, 0] - v * axes[1, 0]) * ANCHOR_STEPS) + 128
                north = np.round((foot[1] - u * axes[0, 1] - v * axes[1, 1]) * ANCHOR_STEPS) + 128
                for s in range(shifts.shape[0]):
                    row, column = (shifts[s, 1] + corner[1] + j) % rows, (shifts[s, 0] + corner[0] + i) % columns
                    for axis in range(3):
                        atlas_mask[axis, k, row, column] |= mask[axis, k, j, i]
                        atlas_normal[k, row, column, axis] += normal[k, j, i, axis]
                    for n in range(sums.shape[3]):
                        atlas_sums[k, row, column, n] += sums[k, j, i, n]
                    atlas_area[k, row, column] += area[k, j, i]
                    if area[k, j, i] > atlas_most[k, row, column]:
                        atlas_most[k, row, column] = area[k, j, i]
                        atlas_anchor[k, row, column, 0] = np.uint8(min(max(east, 0.0), 255.0))
                        atlas_anchor[k, row, column, 1] = np.uint8(min(max(north, 0.0), 255.0))
                        atlas_anchor[k, row, column, 3] = np.uint8(rank)


@njit(cache=True, nogil=True)
def extend(full, normal, anchor, axes):
    """Give the air within two rows of voxels of matter the mean normal and the nearest tree of that matter, in place.

    Linear filtering mixes a surface's voxel with its empty neighbours: these must carry its normal, and point to its
    tree.

    Args:
        full: (K, J, I) whether a voxel holds matter; periodic in J and I. normal: (K, J, I, 3). anchor: uint8 (K, J,
        I, 4).
        axes: (2, 2) sides of a voxel [m] along i and j.
    """
    layers, rows, columns = full.shape
    for k in range(layers):
        for j in range(rows):
            for i in range(columns):
                if full[k, j, i]:
                    continue
                for radius in range(1, 3):
                    if _borrow(full, normal, anchor, axes, k, j, i, radius):
                        break


@njit(cache=True, nogil=True)
def _borrow(full, normal, anchor, axes, k, j, i, radius):
    """Take normal, foot and rank of the matter within `radius` voxels of voxel (k, j, i): whether there is any."""
    layers, rows, columns = full.shape
    nearest, rank = 1000000, 0
    x, y, z, weight, east, north = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for dk in range(max(-radius, -k), min(radius, layers - 1 - k) + 1):
        for dj in range(-radius, radius + 1):
            for di in range(-radius, radius + 1):
                row, column = (j + dj) % rows, (i + di) % columns
                # Two rows in each of the lattice's three directions: no farther across the diagonal either.
                if abs(di + dj) > 2 or not full[k + dk, row, column]:
                    continue
                squared = dk * dk + dj * dj + di * di
                weight += 1.0 / squared
                x += normal[k + dk, row, column, 0] / squared
                y += normal[k + dk, row, column, 1] / squared
                z += normal[k + dk, row, column, 2] / squared
                if squared < nearest:
                    nearest = squared
                    rank = anchor[k + dk, row, column, 3] & 127
                    east = (di * axes[0, 0] + dj * axes[1, 0]) * ANCHOR_STEPS + anchor[k + dk, row, column, 0]
                    north = (di * axes[0, 1] + dj * axes[1, 1]) * ANCHOR_STEPS + anchor[k + dk, row, column, 1]
    if nearest == 1000000:
        return False
    normal[k, j, i, 0], normal[k, j, i, 1], normal[k, j, i, 2] = x / weight, y / weight, z / weight
    anchor[k, j, i, 0] = np.uint8(min(max(np.round(east), 0.0), 255.0))
    anchor[k, j, i, 1] = np.uint8(min(max(np.round(north), 0.0), 255.0))
    anchor[k, j, i, 3] = np.uint8(rank)
    return True


@njit(cache=True, nogil=True)
def add_transmittance(extinction, shift, path, parts, weight, prefix, result):
    """Add one direction's transmittance from the sky to every voxel's centre.

    The sum runs in a frame sheared along the direction, where every ray is a column: one interpolation in, one out.

    Args:
        extinction: (K, J, I) [1/m], periodic in J and I. shift: (2,) voxels (i, j) gained a layer upwards.
        path: length [m] inside a layer. parts: samples a layer. weight: of this direction.
        prefix: scratch like `extinction`. result: sum so far, in place.
    """
    layers, rows, columns = extinction.shape
    above = np.zeros((rows, columns), np.float32)
    for k in range(layers - 1, -1, -1):
        layer = np.zeros((rows, columns), np.float32)
        for part in range(parts):
            place = k + (part + 0.5) / parts - 0.5
            gather(extinction[k], place * shift[0], place * shift[1], np.float32(path / parts), layer)
        prefix[k] = above + np.float32(0.5) * layer
        above += layer
    for k in range(layers):
        layer = np.zeros((rows, columns), np.float32)
        gather(prefix[k], -k * shift[0], -k * shift[1], np.float32(1.0), layer)
        result[k] += np.float32(weight) * np.exp(-layer)


@njit(cache=True, nogil=True)
def gather(source, di, dj, scale, result):
    """Add `scale` times the periodic image, moved by a fraction of a voxel, to `result`."""
    rows, columns = source.shape
    low_i, low_j = int(np.floor(di)), int(np.floor(dj))
    fi, fj = np.float32(di - low_i), np.float32(dj - low_j)
    one = np.float32(1.0)
    for j in range(rows):
        a, b = source[(j + low_j) % rows], source[(j + low_j + 1) % rows]
        for i in range(columns):
            c, d = (i + low_i) % columns, (i + low_i + 1) % columns
            result[j, i] += scale * (
                (one - fj) * ((one - fi) * a[c] + fi * a[d]) + fj * ((one - fi) * b[c] + fi * b[d])
            )
