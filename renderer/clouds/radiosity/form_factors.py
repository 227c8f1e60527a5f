"""Form factors between the ground and a level cloud base, in closed form.

A form factor is the share of the light leaving one diffuse surface that reaches another; seen from the receiver, the
share of its hemisphere, weighted by the cosine, that the other fills. Lengths are in one unit throughout.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

Reading = Literal["texels", "taps", "discs"]
"""How the footprints of the levels are read: the texel that holds the point, the reach of a bilinear tap, or discs."""

LEVELS = (1.0, 2.0, 8.0)
"""Width of a texel of the three levels, in heights of the cloud base (Bouthors, Neyret and Lefebvre 2006)."""


def disc(radius: np.ndarray | float, height: float = 1.0) -> np.ndarray:
    """Form factor of a disc seen from the foot of its axis, `height` away (formulas a7)."""
    square = np.square(radius)
    return np.asarray(square / (square + height * height))


def _corner(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Form factor of the rectangle [0, a] x [0, b] at distance 1 from a point under its corner; odd in both."""
    wide, deep = np.sqrt(1 + a * a), np.sqrt(1 + b * b)
    return (a / wide * np.arctan(b / wide) + b / deep * np.arctan(a / deep)) / (2 * np.pi)


def rectangle(
    x: tuple[np.ndarray | float, np.ndarray | float],
    y: tuple[np.ndarray | float, np.ndarray | float],
    height: float = 1.0,
) -> np.ndarray:
    """Form factor of a level rectangle seen from a level point at the origin, `height` away (formulas a7).

    Args:
        x, y: its two ends along either axis, counted from the point's foot; arrays broadcast.
    """
    (x0, x1), (y0, y1) = ((np.asarray(end, np.float64) / height for end in ends) for ends in (x, y))
    return _corner(x1, y1) - _corner(x0, y1) - _corner(x1, y0) + _corner(x0, y0)


def square(side: np.ndarray | float, height: float = 1.0) -> np.ndarray:
    """Form factor of a square seen from the foot of its middle."""
    half = np.asarray(side, np.float64) / 2
    return rectangle((-half, half), (-half, half), height)


def cells(reach: int, cell: float, height: float = 1.0) -> np.ndarray:
    """Mean form factor from one square cell to those of a like grid in the plane opposite.

    The mean over the receiving cell is exact: the fourth antiderivative of the kernel (Ehlert and Smith 1993), whose
    second differences along both axes remain where both rectangles are cells of one grid.

    Args:
        reach: cells to either side that are asked for.
        cell: side of a cell.

    Returns:
        (2 reach + 1, 2 reach + 1): by offset along either axis, the middle one opposite. Sums to less than 1.
    """
    offsets = np.arange(-reach - 1, reach + 2) * (cell / height)
    u, v = offsets[:, None], offsets[None, :]
    wide, deep = np.sqrt(u * u + 1), np.sqrt(v * v + 1)
    g = v * wide * np.arctan(v / wide) + u * deep * np.arctan(u / deep) - np.log(u * u + v * v + 1) / 2
    second = np.diff(np.diff(g, 2, axis=0), 2, axis=1) / (2 * np.pi)
    return np.maximum(second * (height / cell) ** 2, 0.0)


def footprints(reading: Reading) -> tuple[np.ndarray, np.ndarray]:
    """Areas [heights squared] and form factors of the three nested footprints, for one reading of formulas a7."""
    widths = np.array(LEVELS)
    if reading == "discs":
        return np.pi * widths**2, disc(widths)
    sides = widths if reading == "texels" else 2 * widths
    return sides**2, square(sides)


def level_weights(reading: Reading, spread_loss: bool = True) -> np.ndarray:
    """Weight of each level's mean in the irradiance (formulas a7).

    The means are over nested footprints, so each ring's mean is the difference of two.

    Args:
        reading: of the footprints.
        spread_loss: give the share of the hemisphere beyond the widest footprint to the coarsest mean; the weights sum
            to 1 then, else to the widest footprint's form factor.
    """
    areas, factors = footprints(reading)
    return nested_weights(areas, factors, spread_loss)


def nested_weights(areas: Sequence[float] | np.ndarray, factors: np.ndarray, spread_loss: bool) -> np.ndarray:
    """Weights of means over nested footprints of growing `areas` that fill the shares `factors` of the hemisphere."""
    areas = np.asarray(areas, np.float64)
    rings = np.diff(factors, prepend=0.0)
    weights = np.zeros(len(areas))
    weights[0] = rings[0]
    for k in range(1, len(areas)):
        scale = rings[k] / (areas[k] - areas[k - 1])
        weights[k] += scale * areas[k]
        weights[k - 1] -= scale * areas[k - 1]
    if spread_loss:
        weights[-1] += 1.0 - factors[-1]
    return weights
