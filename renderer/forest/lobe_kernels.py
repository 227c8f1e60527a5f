"""Compiled inner loops of the lobes' coarser levels: what a block of voxels shows of its leaves, and fits of lobes."""

from __future__ import annotations

import numpy as np
from numba import njit

ROUNDS = 8
"""Steps of a fit, from the children's average: more change the residual by less than a hundredth of itself."""


@njit(cache=True, nogil=True)
def gather(depth, kind, side, layer, steps, lengths, table, total, shown):
    """Sum what each block of one layer of blocks sends, from every eye and for every sun.

    A voxel counts by what an eye outside its block sees of it: its own opacity through what stands in front.

    Args:
        depth: (K, J, I) optical depth of a voxel's length. kind: (K, J, I) int32 row of `table`. side: of a block in
            voxels. layer: of blocks. steps: (V, 3) whole voxels (k, j, i) towards each eye. lengths: (V,) of these
            steps, in voxels. table: (kinds, V, S) what leaves of a kind reflect.
        total: (J / side, I / side, V, S), shown: (J / side, I / side, V): results, zero at first.
    """
    front = np.zeros((side, side, side), np.float32)
    for row in range(total.shape[0]):
        for column in range(total.shape[1]):
            for v in range(steps.shape[0]):
                dk, dj, di = steps[v, 0], steps[v, 1], steps[v, 2]
                for a in range(side):
                    k = side - 1 - a if dk > 0 else a
                    for b in range(side):
                        j = side - 1 - b if dj > 0 else b
                        for c in range(side):
                            i = side - 1 - c if di > 0 else c
                            # The neighbour towards the eye comes first, so that its own front is known.
                            inside = 0 <= k + dk < side and 0 <= j + dj < side and 0 <= i + di < side
                            at = depth[layer * side + k, row * side + j, column * side + i]
                            hidden = np.float32(0.0)
                            if inside:
                                hidden = front[k + dk, j + dj, i + di]
                            if at > 0.0:
                                weight = np.exp(-hidden) * (np.float32(1.0) - np.exp(-at * lengths[v]))
                                shown[row, column, v] += weight
                                number = kind[layer * side + k, row * side + j, column * side + i]
                                for s in range(table.shape[2]):
                                    total[row, column, v, s] += weight * table[number, v, s]
                            front[k, j, i] = hidden + at * lengths[v]


@njit(cache=True, nogil=True)
def _error(c, wanted, weight, lit, inner_even, inner_cross, count):
    """Weighted sum of squares of a lobe's difference from what is wanted."""
    total = 0.0
    for n in range(count):
        inner = c[0] * inner_even[n] + c[1] * inner_cross[n]
        value = c[3]
        if lit[n] > 0.0 and inner > 1e-6:
            value += lit[n] * inner ** c[2]
        total += weight[n] * (value - wanted[n]) ** 2
    return total


@njit(cache=True, nogil=True)
def _solve(matrix, right):
    """Solve a 4 x 4 positive system in place by elimination; the solution is left in `right`."""
    for p in range(4):
        pivot = matrix[p, p]
        for row in range(p + 1, 4):
            factor = matrix[row, p] / pivot
            for column in range(p, 4):
                matrix[row, column] -= factor * matrix[p, column]
            right[row] -= factor * right[p]
    for p in range(3, -1, -1):
        for column in range(p + 1, 4):
            right[p] -= matrix[p, column] * right[column]
        right[p] /= matrix[p, p]


@njit(cache=True, nogil=True)
def refit(total, shown, normal, starts, eyes, suns, least, most, result):
    """Fit a lobe about each block's mean normal to what the block sends: Levenberg 1944, Marquardt 1963.

    Args:
        total, shown: of `gather`. normal: (J, I, 3) unit. starts: (J, I, 4) coefficients. eyes: (V, 3), suns: (S, 3)
            unit. least, most: (4,) bounds. result: (J, I, 4), left at the start where nothing is shown.
    """
    size = eyes.shape[0] * suns.shape[0]
    wanted, weight, lit = np.empty(size), np.empty(size), np.empty(size)
    even, cross = np.empty(size), np.empty(size)
    matrix, right = np.empty((4, 4)), np.empty(4)
    slope, c, tried = np.empty(4), np.empty(4), np.empty(4)
    for row in range(total.shape[0]):
        for column in range(total.shape[1]):
            n, count = normal[row, column], np.int64(0)
            for v in range(eyes.shape[0]):
                if shown[row, column, v] <= 1e-6:
                    continue
                seen = eyes[v, 0] * n[0] + eyes[v, 1] * n[1] + eyes[v, 2] * n[2]
                for s in range(suns.shape[0]):
                    facing = suns[s, 0] * n[0] + suns[s, 1] * n[1] + suns[s, 2] * n[2]
                    facing = -facing if seen < 0.0 else facing
                    between = eyes[v, 0] * suns[s, 0] + eyes[v, 1] * suns[s, 1] + eyes[v, 2] * suns[s, 2]
                    wanted[count] = total[row, column, v, s] / shown[row, column, v]
                    weight[count] = shown[row, column, v]
                    lit[count], cross[count] = facing, facing * abs(seen)
                    even[count] = between - cross[count]
                    count += 1
            for k in range(4):
                c[k] = starts[row, column, k]
            if count:
                _descend(c, tried, wanted, weight, lit, even, cross, count, matrix, right, slope, least, most)
            for k in range(4):
                result[row, column, k] = c[k]


@njit(cache=True, nogil=True)
def _descend(c, tried, wanted, weight, lit, even, cross, count, matrix, right, slope, least, most):
    """Improve coefficients `c` in place.

    Coefficients are copied one by one: to compile the assignment of an array takes seconds, for its errors' words.
    """
    best, damping = _error(c, wanted, weight, lit, even, cross, count), 1e-2
    for _ in range(ROUNDS):
        matrix[:], right[:] = 0.0, 0.0
        for n in range(count):
            inner = c[0] * even[n] + c[1] * cross[n]
            slope[:], value = 0.0, c[3]
            slope[3] = 1.0
            if lit[n] > 0.0 and inner > 1e-6:
                power = lit[n] * inner ** c[2]
                value += power
                slope[0] = c[2] * power / inner * even[n]
                slope[1] = c[2] * power / inner * cross[n]
                slope[2] = power * np.log(inner)
            for p in range(4):
                right[p] -= weight[n] * slope[p] * (value - wanted[n])
                for q in range(4):
                    matrix[p, q] += weight[n] * slope[p] * slope[q]
        for p in range(4):
            matrix[p, p] += damping * (matrix[p, p] + 1e-9) + 1e-12
        _solve(matrix, right)
        for p in range(4):
            tried[p] = min(max(c[p] + right[p], least[p]), most[p])
        error = _error(tried, wanted, weight, lit, even, cross, count)
        if error < best:
            for p in range(4):
                c[p] = tried[p]
            best, damping = error, damping * 0.3
        else:
            damping *= 8.0
