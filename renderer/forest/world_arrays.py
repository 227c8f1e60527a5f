"""The forest as plain arrays and numbers, for whoever draws it without the techniques: the reference."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.forest.world_scale import CANOPY_HEIGHT, CELL, FADE, REACH, TILE_SIDE, VOXEL
from renderer.world.sky import sky_cells, sky_for, sky_radiance, sky_sun_disc
from renderer.world.sun import angles, direction

if TYPE_CHECKING:
    from renderer.forest.state import ForestState

NEEDS = ("sky", "terrain", "pattern")
"""Bakes that make the world; the others serve techniques."""


def world_arrays(state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, Any]:
    """What stands where, and the light it stands in.

    Args:
        state: the document; techniques and view are no part of the world.
        baked: arrays of `NEEDS`.

    Returns:
        By name: the arrays of the ground (`elevation`, `cover`, `presence`, `species`, `growth`), of the pattern
        (`colour`, `normal`, `anchor`, `tile`), and the numbers that scale, seed and light them, named as in its world;
        `background`, the radiance of the sky for unit directions (M, 3), W m-2 sr-1.
    """
    ground, pattern = baked["terrain"], baked["pattern"]
    sun = direction(state.sun)
    now = sky_for(baked["sky"], angles(state.sun)[1])

    def background(directions: np.ndarray) -> np.ndarray:
        return sky_radiance(now, sun, directions) + sky_sun_disc(now, sun, directions)

    return {
        "elevation": ground["elevation"],
        "cover": ground["cover"],
        "presence": ground["presence"] / 255.0,
        "species": ground.get("species"),
        "growth": ground["growth"],
        "cell": CELL,
        "canopy_height": CANOPY_HEIGHT,
        "tile_side": TILE_SIDE,
        "voxel": VOXEL,
        "reach": REACH,
        "fade": FADE,
        **{name: np.asarray(pattern[name]) for name in ("colour", "normal", "anchor", "tile")},
        "seed": state.ground.map_seed,
        "tint_strength": state.ground.tint_strength,
        "ground_albedo": tuple(state.ground.albedo),
        "patches": state.ground.patches,
        "leaf_transmission": _triple(state.ground.translucency * np.asarray(state.ground.glow)),
        "e_sun": _triple(now.sun_irradiance),
        "e_sky": _triple(now.sky_irradiance),
        "sun": _triple(sun),
        "sky": sky_cells(now, sun),
        "background": background,
    }


def _triple(values: np.ndarray) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])
