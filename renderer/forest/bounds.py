"""Bounds of land and trees, by which rays take safe steps."""

from __future__ import annotations

import numpy as np

from renderer.forest.world_scale import CANOPY_HEIGHT, CELL


def bounds(elevation: np.ndarray, tree: float) -> dict[str, float]:
    """What no ray need look beyond: the steepest rise over run of the ground, and the tops of trees and scene [m]."""
    east = np.abs(np.diff(elevation, axis=1)) / CELL
    north = np.abs(np.diff(elevation, axis=0)) / CELL
    steepest = np.hypot(np.maximum(east[:-1], east[1:]), np.maximum(north[:, :-1], north[:, 1:])).max()
    # The slope along a line jumps where two cells meet, and changes steadily inside a twisted one.
    jumps = [np.abs(np.diff(elevation, n=2, axis=axis)).max() / CELL**2 for axis in (0, 1)]
    twist = np.abs(np.diff(np.diff(elevation, axis=0), axis=1)).max() / CELL**2
    return {
        "terrain_steepness": float(steepest),
        "terrain_bend": float(sum(jumps) + 2 * twist),
        "canopy_top": tree,
        "scene_top": float(elevation.max()) + tree,
    }


def stretch(growth: np.ndarray) -> dict[str, float]:
    """How low the canopy's layer gets against the pattern's, and its greatest rise over run."""
    steps = [np.abs(np.diff(growth, axis=axis)).max() * CANOPY_HEIGHT / CELL for axis in (0, 1)]
    return {"canopy_least": float(growth.min()), "canopy_grade": float(np.hypot(*steps))}
