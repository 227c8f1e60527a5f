"""Surfaces of revolution: a vase and a mushroom, smooth curves through a few points turned around the z axis."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline

from renderer.shells.base_mesh import BaseMesh
from renderer.shells.surface_grids import arc_lengths, turned

VASE = np.array([
    (0.0, 0.0), (0.13, 0.0), (0.185, 0.012), (0.17, 0.06), (0.175, 0.12), (0.25, 0.27), (0.33, 0.45), (0.325, 0.62),
    (0.24, 0.77), (0.15, 0.86), (0.125, 0.92), (0.145, 0.97), (0.185, 1.0),
])
"""Radius and height from the middle of the foot to the lip, for a height of 1."""

MUSHROOM = np.array([
    (0.0, 0.0), (0.1, 0.0), (0.15, 0.03), (0.14, 0.16), (0.12, 0.34), (0.115, 0.5), (0.15, 0.57), (0.27, 0.575),
    (0.42, 0.56), (0.5, 0.585), (0.49, 0.68), (0.38, 0.85), (0.2, 0.97), (0.0, 1.0),
])
"""Radius and height from the middle of the stem's foot over the cap to its top, for a height of 1."""

FINE = 4000
"""Points at which a curve's length is measured."""

BENDS = 0.6
"""Weight of a curve's turning against its length where it is cut into cells."""


def curve(points: np.ndarray, cells: int) -> np.ndarray:
    """A smooth curve through points, cut more finely where it bends, (cells + 1, 2).

    A cubic spline in the length of the polygon through the points. Its cells share out its length, and `BENDS` times
    as much all that it turns by.
    """
    along = arc_lengths(points)
    # Level where it leaves the axis, so that the turned surface has no point there.
    level = ((1, (points[1] - points[0]) / (along[1] - along[0])), "natural")
    spline = CubicSpline(along, points, bc_type=level)
    fine = spline(np.linspace(0, 1, FINE))
    step = np.diff(fine, axis=0)
    turn = np.abs(np.diff(np.unwrap(np.arctan2(step[:, 1], step[:, 0]))))
    bends = np.concatenate([[0.0], np.cumsum(np.append(turn, 0.0))])
    shares = (arc_lengths(fine) + BENDS * bends / bends[-1]) / (1 + BENDS)
    places = np.interp(np.arange(cells + 1) / cells, shares, np.linspace(0, 1, FINE))
    found: np.ndarray = spline(places)
    found[[0, -1]] = points[[0, -1]]
    return found


def turned_curve(
    points: np.ndarray, height: float, around: int, cells: int, repeat_u: float, repeat_v: float
) -> BaseMesh:
    """The surface of a curve for a height of 1, centred at the origin.

    Args:
        points: (N, 2) radius and height. height: m.
        around, cells: around the axis, and along the curve.
        repeat_u, repeat_v: how often the texture repeats around, and along the curve.
    """
    profile = curve(points, cells) * height
    profile[:, 1] -= height / 2
    return turned(profile, around, repeat_u, arc_lengths(profile) * repeat_v)
