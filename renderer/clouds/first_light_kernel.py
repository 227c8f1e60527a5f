"""Loops of the first light over the places of its square, compiled, and the axis of the tables that they read."""

from __future__ import annotations

import numpy as np
from numba import njit

LEAST, MOST = -10, 14
"""Optical depths of a table's second and of its last doubling, as powers of two."""

BITS = 4
"""Of a depth's mantissa that number the entries of one doubling: the bits of a float are its place in the table."""

DEPTHS = np.append(0.0, np.outer(2.0 ** np.arange(LEAST, MOST), 1 + np.arange(1 << BITS) / (1 << BITS)))
"""Optical depths of a table's entries."""

_FIRST = (127 + LEAST) << BITS  # a float32's exponent is counted from -127
_REST = 23 - BITS


@njit(cache=True, nogil=True)
def gather(fields, turn, rows, columns, curve, axis, weather):
    """Optical depths over the places (P, Q) float32 of a map made of periodic fields, texel by texel.

    Args:
        fields: (2, N, N). turn: share of each, (2,). rows, columns: texels looked at, (P,) and (Q,).
        curve: thickness (M,) by the fields' sum. axis: the sum at its first entry, its entries for each unit, and the
            optical depth of the whole layer. weather: what it leaves of the layer, (P, Q).
    """
    found = np.empty(weather.shape, np.float32)
    last = curve.size - 2
    for i in range(found.shape[0]):
        one, other = fields[0, rows[i]], fields[1, rows[i]]
        for j in range(found.shape[1]):
            x = (turn[0] * one[columns[j]] + turn[1] * other[columns[j]] - axis[0]) * axis[1]
            low = min(max(int(x), 0), last)
            share = min(max(x - low, np.float32(0)), np.float32(1))
            thickness = curve[low] + share * (curve[low + 1] - curve[low])
            found[i, j] = max(thickness, np.float32(0)) * weather[i, j] * axis[2]
    return found


@njit(cache=True, nogil=True)
def _place(depth, bits, last):
    """Entry below a depth and the share of the way to the next, by the bits of the depth."""
    if depth < DEPTHS[1]:
        return 0, depth * np.float32(1.0 / DEPTHS[1])
    low = min((bits >> _REST) - _FIRST + 1, last)
    return low, min(np.float32(bits & ((1 << _REST) - 1)) * np.float32(1.0 / (1 << _REST)), np.float32(1))


@njit(cache=True, nogil=True)
def light_cells(within, sun, sharpness, slopes, horizon, at, albedo, overhead, above, along, beam):
    """What sun and sky lay on the ground, what it sends back of that, and what the layer sends back from below.

    Args:
        within: places along each side of a cell. sun: its direction, (3,). sharpness: of summits' shadows, one over the
            sine of the sun's width.
        slopes: rise to the east and to the north, and one over the normal's length, (P, P, 3).
        horizon: sine above which the nodes of the land see the sun, (N, N).
        at: node of a place along either axis, (P,), below 0 where there is none.
        albedo: (P, P, 3). overhead, along: optical depths over a place and along its sun's ray, (P, P).
        above: by optical depth, what arrives through the layer overhead and what that sends back, (D, 6).
        beam: by optical depth, what arrives along the ray on a surface that faces it, (D, 3). All in float32.

    Returns:
        Means over cells, (3, P / within, P / within, 3).
    """
    n = overhead.shape[0] // within
    found = np.zeros((3, n, n, 3))
    bits, bits_along = overhead.view(np.int32), along.view(np.int32)
    last = above.shape[0] - 2
    none, whole = np.float32(0), np.float32(1)
    for i in range(n * within):
        for j in range(n * within):
            facing = max(sun[2] - slopes[i, j, 0] * sun[0] - slopes[i, j, 1] * sun[1], none) * slopes[i, j, 2]
            if at[i] >= 0 and at[j] >= 0:
                t = min(max((sun[2] - horizon[at[i], at[j]]) * sharpness + np.float32(0.5), none), whole)
                facing *= t * t * (np.float32(3) - t - t)
            low, share = _place(overhead[i, j], bits[i, j], last)
            far, rest = _place(along[i, j], bits_along[i, j], last)
            for c in range(3):
                arrives = above[low, c] + share * (above[low + 1, c] - above[low, c])
                light = arrives + facing * (beam[far, c] + rest * (beam[far + 1, c] - beam[far, c]))
                found[0, i // within, j // within, c] += light
                found[1, i // within, j // within, c] += light * albedo[i, j, c]
                sent_back = above[low, 3 + c] + share * (above[low + 1, 3 + c] - above[low, 3 + c])
                found[2, i // within, j // within, c] += sent_back
    return found / within**2
