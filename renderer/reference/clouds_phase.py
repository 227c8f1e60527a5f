"""The droplets' phase function for paths: its forward peak apart from the rest, each to evaluate and to draw from.

P = A + B: A is what stands above P's least value within `PEAK` of straight on, B everything else. Both are kept
unnormalised, so that the integral of A is the peak's share f of the scattered light and that of B is 1 - f.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]

PEAK = math.radians(14.0)
"""Where the peak ends, rad. Any value gives the same mean; a wider peak leaves B flatter and bends more paths."""

FINE, MIDDLE, BACK = math.radians(0.0125), math.radians(0.1), math.radians(0.02)
"""Steps of the tables up to `TURN`, up to `LATE` and behind it."""

TURN, LATE = math.radians(16.0), math.radians(170.0)

FIRST = round(TURN / FINE)
SECOND = FIRST + round((LATE - TURN) / MIDDLE)
LAST = SECOND + round((math.pi - LATE) / BACK)


GUIDES = 1024
"""Entries that tell where a drawn number lies in a cumulated table."""


PEAK_OF, REST_OF, PEAK_SUM, REST_SUM, COSINES = 0, 3, 6, 9, 12
"""First rows of the tables, a row for each band: the peak and the rest [1/sr], the shares of each up to an angle; one
row of cosines."""


class Scatter(NamedTuple):
    """`values` (13, LAST + 1), the tables; `guides` (6, GUIDES + 1), where a drawn number lies in those of shares;
    `share` (3,), f in each band."""

    values: Floats
    guides: NDArray[np.int64]
    share: Floats


def angles() -> Floats:
    """Scattering angles of the tables, rad."""
    return np.concatenate(
        [
            FINE * np.arange(FIRST),
            TURN + MIDDLE * np.arange(SECOND - FIRST),
            LATE + BACK * np.arange(LAST - SECOND + 1),
        ]
    )


def scatter(moments: Floats) -> Scatter:
    """Tables of a phase function given by its moments (3, L), the first of which are 1."""
    theta = angles()
    value = np.stack([_series(band, np.cos(theta)) for band in moments])
    value = np.maximum(value, 1e-9)
    within = theta < PEAK
    level = value[:, within].min(axis=1, keepdims=True)
    peak = np.where(within, value - level, 0.0)
    solid = 2 * math.pi * -np.diff(np.cos(theta))
    peak_sum, rest_sum = _cumulated(peak, solid), _cumulated(value - peak, solid)
    whole = (peak_sum[:, -1] + rest_sum[:, -1])[:, None]
    peak, rest = peak / whole, (value - peak) / whole
    share = peak_sum[:, -1] / whole[:, 0]
    sums = peak_sum / np.maximum(peak_sum[:, -1:], 1e-300), rest_sum / rest_sum[:, -1:]
    guides = np.stack([_guide(band) for table in sums for band in table])
    return Scatter(np.concatenate([peak, rest, *sums, np.cos(theta)[None]]), guides, share)


def _guide(sums: Floats) -> NDArray[np.int64]:
    """The last entry of a cumulated table that is at most k / GUIDES."""
    found = np.searchsorted(sums, np.arange(GUIDES + 1) / GUIDES, side="right") - 1
    return np.clip(found, 0, LAST - 1).astype(np.int64)


def _series(moments: Floats, cosines: Floats) -> Floats:
    """Sum of (2l + 1) / (4 pi) a_l P_l, by the recurrence of Legendre's polynomials."""
    before, here = np.ones_like(cosines), cosines.copy()
    total = moments[0] * before
    for order in range(1, len(moments)):
        total += (2 * order + 1) * moments[order] * here
        before, here = here, ((2 * order + 1) * cosines * here - order * before) / (order + 1)
    return total / (4 * math.pi)


def _cumulated(values: Floats, solid: Floats) -> Floats:
    parts = 0.5 * (values[:, 1:] + values[:, :-1]) * solid
    return np.concatenate([np.zeros((len(values), 1)), np.cumsum(parts, axis=1)], axis=1)


@njit(cache=True, inline="always")
def place_of(theta):
    """Fractional entry of an angle in the tables."""
    if theta < TURN:
        return theta / FINE
    if theta < LATE:
        return FIRST + (theta - TURN) / MIDDLE
    return min(SECOND + (theta - LATE) / BACK, LAST - 1e-9)


@njit(cache=True, inline="always")
def read(tables, row, place):
    """A table between its entries."""
    low = int(place)
    return tables[row, low] + (place - low) * (tables[row, low + 1] - tables[row, low])


@njit(cache=True, inline="always")
def draw_cosine(tables, guides, row, u):
    """Cosine of an angle drawn from the table of shares in a row, evenly in solid angle between two entries."""
    low = guides[row - PEAK_SUM, int(u * GUIDES)]
    while low < LAST - 1 and tables[row, low + 1] <= u:
        low += 1
    wide = tables[row, low + 1] - tables[row, low]
    share = (u - tables[row, low]) / wide if wide > 0.0 else 0.5
    return tables[COSINES, low] + share * (tables[COSINES, low + 1] - tables[COSINES, low])
