"""What the single and the double horizon map share: their threshold, in closed form and as a numpy twin."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.forest.shadow.double_horizon_map import DoubleHorizonMap
from renderer.forest.shadow.horizon_map import HorizonMap
from tests.forest import worlds

CALL = "shadow_visibility(position, h, uv)"
EPS = 6.0


LAND_SOFTNESS = 0.045
"""Half width of the land's own penumbra at most, radians: land hides the sun wholly, and sharply."""


def threshold(gamma: np.ndarray, phi: np.ndarray, eps: float) -> np.ndarray:
    """Twin of `horizon_lit` in float64, all in radians: errata 000-2 and 000-10."""
    t = np.clip((phi - gamma + eps) / (2 * eps), 0, 1)
    return np.where(phi >= 0, t * t * (3 - 2 * t), 0.0)


def twin(land: Any, canopy: Any, phi: Any, eps: float, strength: float = 1.0) -> np.ndarray:
    """Twin of `horizon_visibility`; degrees."""
    phi, eps = np.radians(phi), np.radians(eps)
    over_land = threshold(np.radians(land), phi, min(eps, LAND_SOFTNESS))
    return over_land * (1 - strength + strength * threshold(np.radians(canopy), phi, eps))


def visibility(
    ask: Callable[..., np.ndarray], technique: HorizonMap | DoubleHorizonMap, elevation: float, *, h: Any = 0.0,
    terrain: float = 0.0, canopy: tuple[float, float] = (0.0, 0.0), cover: float = 1.0, x: Any = 0.0,
) -> np.ndarray:
    """Share of the sun in a world of one terrain horizon and one canopy horizon (top, low); degrees."""
    heights = np.atleast_1d(np.asarray(h, float))
    east = np.broadcast_to(np.asarray(x, float), heights.shape)
    double = isinstance(technique, DoubleHorizonMap)
    maps = np.radians(canopy) if double else np.radians(canopy[1:])
    textures = {"shadow_terrain": np.full((2, 2), np.radians(terrain)),
                "shadow_canopy": np.broadcast_to(maps, (2, 2, len(maps)))}
    inputs = {"position": np.stack([east, 0 * east, 20 * heights], axis=1), "h": heights,
              "uv": np.tile([0.3, 0.6], (len(heights), 1))}
    return ask([f"forest/shadow/{technique.kind}.glsl"], CALL, inputs, 1, techniques={"shadow": technique},
               textures=textures, terrain=worlds.ground(cover=cover),
               state=worlds.state(sun=worlds.sun(100, elevation)))[:, 0].astype(float)


def threshold_error(ask: Callable[..., np.ndarray], technique: HorizonMap | DoubleHorizonMap) -> float:
    """Worst error at Gamma - eps, - eps/2, Gamma, + eps/2, + eps against 0, .15625, .5, .84375, 1 (errata 000-2)."""
    exact = {-1.0: 0.0, -0.5: 0.15625, 0.0: 0.5, 0.5: 0.84375, 1.0: 1.0}
    found = {n: float(visibility(ask, technique, 30 + EPS * n, canopy=(30.0, 30.0))[0]) for n in exact}
    return max(abs(found[n] - exact[n]) for n in exact)
