"""A tabulated reflectance as the GPU holds it: a plane of values, and rulers that find nodes in one step.

The values of one view direction (a node of axes 0 and 1) are a tile: rows are nodes of axis 2, columns of axis 3. Tiles
stand beside and above each other. A ruler cuts its axis into even bins of which none holds two nodes: what a bin knows
of the node in it, or the next after it, gives the interval and the place in it, however uneven the nodes are.
"""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np

from renderer.core.errors import LimitError
from renderer.world.brdf import AXES, PERIODS, BrdfTable

BINS = 4096
"""Most bins of a ruler: nodes closer than that part of their axis cannot be told apart."""

SIDE = 16384
"""Texels that the tiles may be long together: the least that OpenGL 4 allows."""

DECLARATIONS = """uniform ivec4 table_nodes;        // of each axis
uniform int table_across;         // tiles in a row
uniform vec4 table_axes[4];       // first node; period, or 0; last node; bins per unit"""

ORDER = tuple(AXES)

BRIGHTEST = 65504.0
"""Greatest number that half precision holds."""


def ruler(nodes: np.ndarray, period: float) -> tuple[np.ndarray, float]:
    """As `_ruler`, remembered: every frame asks."""
    return _ruler(np.asarray(nodes, np.float64).tobytes(), float(period))


@functools.lru_cache(maxsize=64)
def _ruler(told: bytes, period: float) -> tuple[np.ndarray, float]:
    """Bins (n, 4) of an axis and how many there are per unit.

    A bin holds the interval's number and slope before its node, the node's place counted from the first node, and the
    slope after it; the last bin is met only at the very end.

    Raises:
        LimitError: nodes too close to each other.
    """
    nodes = np.frombuffer(told)
    ends = np.append(nodes - nodes[0], period) if period else nodes - nodes[0]
    if len(ends) == 1:
        return np.array([[0.0, 1.0, 1.0, 0.0]]), 0.0
    slopes = 1 / np.diff(ends)
    count = 16
    while count < BINS and len(np.unique(np.floor(ends[1:-1] / ends[-1] * count))) < len(ends) - 2:
        count *= 2
    bins = np.floor(ends[1:-1] / ends[-1] * count).astype(np.int64)
    if len(np.unique(bins)) < len(ends) - 2:
        closest = math.degrees(1 / slopes.max())
        raise LimitError("brdf", f"has nodes {closest:.3g} degrees apart", f"at least 1/{BINS} of their range")
    # The next node's number of each bin: those of bins before it count as before it.
    following = np.searchsorted(bins, np.arange(count), side="left") + 1
    after = np.minimum(following, len(slopes) - 1)
    table = np.stack([following - 1, slopes[following - 1], ends[following], slopes[after]], axis=-1)
    return np.concatenate([table, table[-1:]]), count / ends[-1]


def tiles_across(shape: tuple[int, ...]) -> int:
    """How many tiles are in a row, for a table of that shape.

    Raises:
        LimitError: more than a texture holds.
    """
    a, b, rows, columns = shape[:4]
    across = min(max(round(math.sqrt(a * b * rows / columns)), 1), a * b, SIDE // columns)
    if across < 1 or -(-a * b // across) * rows > SIDE:
        raise LimitError("brdf", f"has {a * b:,} view directions of {rows} x {columns} values", "what a texture holds")
    return across


def plane(table: BrdfTable, dtype: Any) -> np.ndarray:
    """Texels (rows, columns, 4) of a table's values; raises as `tiles_across`."""
    a, b, rows, columns, _ = table.values.shape
    across = tiles_across(table.values.shape)
    down = -(-a * b // across)
    tiles = np.zeros((down * across, rows, columns, 4), dtype)
    tiles[: a * b, ..., :3] = np.minimum(table.values, BRIGHTEST).reshape(a * b, rows, columns, 3)
    return tiles.reshape(down, across, rows, columns, 4).swapaxes(1, 2).reshape(down * rows, across * columns, 4)


def rulers(table: BrdfTable) -> np.ndarray:
    """Texels (4, longest ruler, 4) float32 of the rulers of the axes."""
    made = [ruler(*axis)[0] for axis in zip(table.nodes, PERIODS[table.coordinates])]
    found = np.zeros((4, max(map(len, made)), 4), np.float32)
    for row, bins in zip(found, made):
        row[: len(bins)] = bins
    return found


def table_macros(table: BrdfTable) -> dict[str, int]:
    """`TABLE_COORDINATES`, of renderer/world/brdf.py's AXES, counted from 0; `TABLE_VIEWS`, neighbouring view nodes."""
    return {
        "TABLE_COORDINATES": ORDER.index(table.coordinates),
        "TABLE_VIEWS": 4 if len(table.nodes[1]) > 1 else 2,
    }


def table_uniforms(table: BrdfTable) -> dict[str, Any]:
    """Values of `DECLARATIONS`."""
    periods = PERIODS[table.coordinates]
    axes = [(nodes[0], period, nodes[-1], ruler(nodes, period)[1]) for nodes, period in zip(table.nodes, periods)]
    return {
        "table_nodes": tuple(len(nodes) for nodes in table.nodes),
        "table_across": tiles_across(table.values.shape),
        "table_axes": np.array(axes),
    }
