"""How a tabulated reflectance is read between its nodes, in float64: twin of `shaders/directional/brdf_table.glsl`.

Porquet 2005, section 3.3.2.2: bilinear in the light for each of the four neighbouring view directions, then bilinear in
the view: five interpolations of 16 values. With three coordinates there are two neighbours and 8 values (errata 003-4).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from renderer.world.brdf import PERIODS, BrdfTable

Ends = tuple[np.ndarray, np.ndarray, np.ndarray]


def coordinates_of(table: BrdfTable, view: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Coordinates (4, N) of pairs of directions.

    Args:
        view, light: unit vectors (N, 3) in the surface's frame; one below the horizon counts as level.
    """
    view, light = _raised(view), _raised(light)
    zero = np.zeros(len(view))
    if table.coordinates == "half":
        half = view + light
        half = half / np.linalg.norm(half, axis=1, keepdims=True)
        theta, phi = _theta(half), np.arctan2(half[:, 1], half[:, 0])
        down = np.stack([half[:, 2] * np.cos(phi), half[:, 2] * np.sin(phi), -np.sin(theta)], axis=-1)
        beside = np.stack([-np.sin(phi), np.cos(phi), zero], axis=-1)
        x, y, z = ((light * axis).sum(axis=1) for axis in (down, beside, half))
        return np.stack([np.sqrt(theta / (0.5 * math.pi)), zero, np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)])
    if table.coordinates == "difference":
        turned = view[:, 0] * light[:, 1] - view[:, 1] * light[:, 0]
        along = view[:, 0] * light[:, 0] + view[:, 1] * light[:, 1]
        return np.stack([_theta(view), zero, _theta(light), np.arctan2(turned, along)])
    azimuths = (np.arctan2(way[:, 1], way[:, 0]) for way in (view, light))
    return np.stack([_theta(view), next(azimuths), _theta(light), next(azimuths)])


def _raised(directions: np.ndarray) -> np.ndarray:
    """Directions with those below the horizon made level."""
    level = np.asarray(directions, np.float64) * [1, 1, 0] + np.maximum(directions, 0) * [0, 0, 1]
    return np.asarray(level / np.maximum(np.linalg.norm(level, axis=1, keepdims=True), 1e-300))


def _theta(directions: np.ndarray) -> np.ndarray:
    return np.asarray(np.arctan2(np.hypot(directions[:, 0], directions[:, 1]), directions[:, 2]))


def between(nodes: np.ndarray, period: float, at: np.ndarray) -> Ends:
    """Numbers of the nodes before and after places (N,) on an axis, and how far it is from one to the other (0..1).

    Beyond the ends of an axis without a period the last node stands.
    """
    first = nodes[0]
    along = np.mod(at - first, period) if period else np.clip(at, first, nodes[-1]) - first
    ends = np.append(nodes - first, period) if period else nodes - first
    if len(ends) == 1:
        none = np.zeros(len(at), np.int64)
        return none, none, np.zeros(len(at))
    before = np.clip(np.searchsorted(ends, along, side="right") - 1, 0, len(ends) - 2)
    share = (along - ends[before]) / (ends[before + 1] - ends[before])
    return before, (before + 1) % len(nodes), share


def lookup(table: BrdfTable, view: np.ndarray, light: np.ndarray) -> np.ndarray:
    """Reflectance (N, 3) [sr-1] between the nodes of a table.

    Args:
        view, light: unit vectors (N, 3) in the surface's frame: tangent, bitangent, normal.
    """
    at = coordinates_of(table, view, light)
    found = [between(*axis) for axis in zip(table.nodes, PERIODS[table.coordinates], at)]
    return _bilinear(found[:2], lambda a, b: _bilinear(found[2:], lambda c, d: table.values[a, b, c, d]))


def _bilinear(axes: Sequence[Ends], value: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """Bilinear between the values of four neighbours (Porquet 2005: C_a, C_b, C)."""
    (k0, k1, along_theta), (m0, m1, along_phi) = axes
    one, other = along_theta[:, None], along_phi[:, None]
    low = value(k0, m0) + other * (value(k0, m1) - value(k0, m0))
    high = value(k1, m0) + other * (value(k1, m1) - value(k1, m0))
    return np.asarray(low + one * (high - low))
