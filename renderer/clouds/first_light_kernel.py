"""Reading of tables over optical depth, for many places at once."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

LEAST, MOST, STEPS = 1e-3, 1e4, 255
"""Optical depths of a table's second and last entry, and how many steps of one ratio lie between."""

DEPTHS = np.concatenate([[0.0], np.geomspace(LEAST, MOST, STEPS + 1)])
"""Optical depths of a table's entries."""

_STEP = math.log(MOST / LEAST) / STEPS


@njit(cache=True, nogil=True)
def read(table, depths, entries):
    """Values at optical depths (P, Q), linearly between those of a table (D, C) at `entries` (D,): (P, Q, C)."""
    last = entries.size - 2
    found = np.empty((depths.shape[0], depths.shape[1], table.shape[1]))
    for i in range(depths.shape[0]):
        for j in range(depths.shape[1]):
            depth = depths[i, j]
            low = 0 if depth <= LEAST else min(1 + int(math.log(depth / LEAST) / _STEP), last)
            # a logarithm's rounding may miss the entry by one
            while low < last and entries[low + 1] <= depth:
                low += 1
            while low > 0 and entries[low] > depth:
                low -= 1
            share = min((depth - entries[low]) / (entries[low + 1] - entries[low]), 1.0)
            for c in range(table.shape[1]):
                found[i, j, c] = table[low, c] + share * (table[low + 1, c] - table[low, c])
    return found
