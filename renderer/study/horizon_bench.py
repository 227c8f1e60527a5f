"""What horizons cost: sweeps of whole height fields against a search from every node, and how far they lie apart."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.reference.horizon import horizon
from renderer.world.horizon_sweep import sweep, sweeps
from renderer.world.terrain import DEFAULT_CENTRE, crop, default_terrain

SIDE = 4096.0
"""Side of the square of the default elevation model [m], resampled to grids of these sizes."""
SIZES = (512, 1024, 2048)

AZIMUTHS = 8
NODES = 400
"""Nodes that are searched, of all that are swept: a search takes hundreds of times as long."""

OFF_AXIS = 0.1
"""First azimuth [rad]: no line falls on the grid's own."""


def time_horizons(
    sizes: tuple[int, ...] = SIZES, progress: Callable[[float, str], None] | None = None
) -> list[dict[str, Any]]:
    """Time the sweep and the exact search on one core each, and the sweep on all of them.

    Args:
        sizes: nodes a side. progress: told the share done.

    Returns:
        For each size `nodes`, `cell_size` [m], `azimuths`; cell-azimuths a second of processor time: `swept_per_core`,
        `searched_per_core`; and of the clock on all cores: `swept`; the distance between the two in degrees:
        `median_error`, `p99_error`.
    """
    azimuths = OFF_AXIS + np.arange(AZIMUTHS) * (2 * math.pi / AZIMUTHS)
    sweep(np.zeros((4, 4)), (1.0, 1.0), OFF_AXIS)  # the first call compiles
    horizon(np.zeros((4, 4)), (1.0, 1.0), np.ones((1, 2)), azimuths)
    found = []
    for number, size in enumerate(sizes):
        if progress is not None:
            progress(number / len(sizes), f"sweeping {size} x {size} nodes")
        cell = SIDE / size
        heights = crop(default_terrain(), DEFAULT_CENTRE, SIDE, cell).elevation.astype(np.float64)
        points = np.random.default_rng(1).integers(1, size - 1, (NODES, 2))
        start = time.process_time()
        swept = [sweep(heights, (cell, cell), azimuth)[points[:, 0], points[:, 1]] for azimuth in azimuths]
        alone = time.process_time() - start
        start = time.perf_counter()
        for _ in sweeps(heights, (cell, cell), list(azimuths)):
            pass
        together = time.perf_counter() - start
        start = time.process_time()
        exact, _ = horizon(heights, (cell, cell), points.astype(float), azimuths)
        searched = time.process_time() - start
        error = np.degrees(np.abs(np.arctan(np.stack(swept, axis=1)) - exact))
        found.append(
            {
                "nodes": size,
                "cell_size": cell,
                "azimuths": AZIMUTHS,
                "cores": os.cpu_count(),
                "swept_per_core": size * size * AZIMUTHS / alone,
                "swept": size * size * AZIMUTHS / together,
                "searched_per_core": NODES * AZIMUTHS / searched,
                "median_error": float(np.median(error)),
                "p99_error": float(np.quantile(error, 0.99)),
            }
        )
    return found
