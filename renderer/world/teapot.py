"""Newell's teapot: its published bicubic Bézier patches, as the few numbers that they are made of.

M. Newell 1975, with the bottom that F. Crow added ("The origins of the teapot", 1987). The body, the lid and the bottom
are curves turned around the z axis by quarters; handle and spout are closed sections along a curve, with the plane
y = 0 as their mirror. Lengths are the publication's own, z up, the handle towards -x.
"""

from __future__ import annotations

import numpy as np

BODY = np.array([
    (0.0, 0.0, 0.0), (1.425, 0.798, 0.0), (1.5, 0.84, 0.075), (1.5, 0.84, 0.15),
    (1.5, 0.84, 0.225), (2.0, 1.12, 0.45), (2.0, 1.12, 0.9),
    (2.0, 1.12, 1.35), (1.75, 0.98, 1.875), (1.5, 0.84, 2.4),
    (1.4375, 0.805, 2.53125), (1.3375, 0.749, 2.53125), (1.4, 0.784, 2.4),
])
"""Radius, the same times the share of it at which a quarter's inner control points stand, and height: from the middle
of the bottom to the rim, in four patches."""

LID = np.array([
    (1.3, 0.728, 2.4), (1.3, 0.728, 2.55), (0.4, 0.224, 2.55), (0.2, 0.112, 2.7),
    (0.0, 0.0, 2.85), (0.8, 0.45, 3.15), (0.0, 0.0, 3.15),
])
"""The same from the lid's edge to the top of its knob, in two patches."""

HANDLE = np.array([
    (-1.6, 2.025, -1.5, 2.25, 0.3), (-2.3, 2.025, -2.5, 2.25, 0.3), (-2.7, 2.025, -3.0, 2.25, 0.3),
    (-2.7, 1.8, -3.0, 1.8, 0.3), (-2.7, 1.575, -3.0, 1.35, 0.3), (-2.5, 1.125, -2.65, 0.9375, 0.3),
    (-2.0, 0.9, -1.9, 0.6, 0.3),
])
"""Sections from its upper end to its lower one: x and z of the inner side, x and z of the outer side, half width."""

SPOUT = np.array([
    (1.7, 1.425, 1.7, 0.6, 0.66), (2.6, 1.425, 3.1, 0.825, 0.66), (2.3, 2.1, 2.4, 2.025, 0.25),
    (2.7, 2.4, 3.3, 2.4, 0.25), (2.8, 2.475, 3.525, 2.49375, 0.25), (2.9, 2.475, 3.45, 2.5125, 0.15),
    (2.8, 2.4, 3.2, 2.4, 0.15),
])
"""Sections from the body to its mouth: x and z of the upper side, x and z of the lower side, half width."""

BODY_CELLS, LID_CELLS, HANDLE_CELLS, SPOUT_CELLS = (28, (3, 4, 5, 3)), (26, (5, 4)), (12, 17), (12, 20)
"""Cells around, and along each patch or the whole: 2,142 triangles (Dufort 2005, table 6.1, which counts twelve for
each)."""


def quarters(profile: np.ndarray) -> np.ndarray:
    """Control points of a curve turned around z, (R, 13, 3), counter-clockwise from +x."""
    radius, inner, height = profile.T
    none = np.zeros_like(radius)
    x = [radius, radius, inner, none, -inner, -radius, -radius, -radius, -inner, none, inner, radius, radius]
    y = [none, inner, radius, radius, radius, inner, none, -inner, -radius, -radius, -radius, -inner, none]
    return np.stack([np.stack(x, axis=1), np.stack(y, axis=1), np.repeat(height[:, None], 13, axis=1)], axis=-1)


def sections(rows: np.ndarray) -> np.ndarray:
    """Control points of closed sections, (R, 7, 3): from one side over y < 0 to the other, and back over y > 0."""
    x0, z0, x1, z1, half = rows.T
    none = np.zeros_like(half)
    x, z = [x0, x0, x1, x1, x1, x0, x0], [z0, z0, z1, z1, z1, z0, z0]
    y = [none, -half, -half, none, half, half, none]
    return np.stack([np.stack(part, axis=1) for part in (x, y, z)], axis=-1)


def bezier(count: int, places: np.ndarray) -> np.ndarray:
    """Weights (N, 3 count + 1) of the control points of `count` cubic pieces at places in [0, count]."""
    piece = np.minimum(places.astype(int), count - 1)
    t = places - piece
    weights = np.zeros((len(places), 3 * count + 1))
    for k, weight in enumerate(((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3)):
        weights[np.arange(len(places)), 3 * piece + k] = weight
    return weights


def along(cells: tuple[int, ...], finer: int) -> np.ndarray:
    """Places of the nodes that cut each piece into its number of cells, times `finer`."""
    pieces = [piece + np.arange(count * finer) / (count * finer) for piece, count in enumerate(cells)]
    return np.append(np.concatenate(pieces), len(cells))


def nodes(control: np.ndarray, rows: np.ndarray, around: int) -> np.ndarray:
    """Nodes (N, around + 1, 3) of a closed grid of patches.

    The last column is the first again, and a pole is one place, to the last bit.
    """
    down, across = len(control) // 3, control.shape[1] // 3
    columns = bezier(across, np.arange(around + 1) / around * across)
    surface: np.ndarray = np.einsum("nr,mc,rck->nmk", bezier(down, rows), columns, control)
    surface[:, -1] = surface[:, 0]
    poles = np.ptp(surface, axis=1).max(axis=1) < 1e-12
    surface[poles] = surface[poles, :1]
    return surface
