"""Directions of a hemisphere: rows of equal azimuths and the zenith, as Porquet 2005 counts them (16 x 8 + 1 = 129)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

LAYOUTS = {33: (8, 4), 129: (16, 8), 513: (32, 16), 2049: (64, 32)}
"""Azimuths and rows by the number of directions."""


@dataclass(frozen=True)
class Hemisphere:
    """Directions about an axis, numbered row by row from the horizon up, the zenith last.

    Row k stands (k + 1/2) steps above the horizon and the zenith one step above the last row, so that every direction
    is within half a step of its row. Azimuth a is a/azimuths of a turn from the first axis towards the second.

    Args:
        azimuths: of a row. elevations: rows.
    """

    azimuths: int
    elevations: int

    @property
    def count(self) -> int:
        """How many directions there are."""
        return self.azimuths * self.elevations + 1

    @property
    def step(self) -> float:
        """Between rows [rad]."""
        return math.pi / 2 / (self.elevations + 0.5)

    def elevation(self) -> np.ndarray:
        """(elevations,) of the rows above the horizon [rad]."""
        return (np.arange(self.elevations) + 0.5) * self.step

    def directions(self) -> np.ndarray:
        """(count, 3) unit vectors along the first axis, the second and the normal."""
        elevation = np.repeat(self.elevation(), self.azimuths)
        azimuth = np.tile(np.arange(self.azimuths) * (2 * math.pi / self.azimuths), self.elevations)
        level = np.cos(elevation)
        rows = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], axis=-1)
        return np.concatenate([rows, [[0.0, 0.0, 1.0]]])

    def cells(self) -> np.ndarray:
        """(elevations * azimuths, 4) numbers of the directions round each cell between two rows and two azimuths: the
        lower row's left and right, the upper one's."""
        row, left = np.divmod(np.arange(self.elevations * self.azimuths), self.azimuths)
        sides = np.stack([left, (left + 1) % self.azimuths], axis=-1)
        lower, upper = row[:, None] * self.azimuths + sides, (row[:, None] + 1) * self.azimuths + sides
        return np.concatenate([lower, np.minimum(upper, self.count - 1)], axis=-1)

    def nearest(self, directions: np.ndarray) -> np.ndarray:
        """Numbers (...) of the cells that unit vectors (..., 3) lie in; those below the horizon count as level."""
        elevation = np.arcsin(np.clip(directions[..., 2], 0.0, 1.0))
        row = np.minimum((elevation / self.step).astype(np.int64), self.elevations)
        turn = np.arctan2(directions[..., 1], directions[..., 0]) / (2 * math.pi) * self.azimuths
        azimuth = np.floor(turn + 0.5).astype(np.int64) % self.azimuths
        return np.where(row == self.elevations, self.count - 1, row * self.azimuths + azimuth)

    def solid_angles(self) -> np.ndarray:
        """(count,) of the cells, 2 pi together [sr]."""
        edges = np.sin(np.arange(self.elevations + 1) * self.step)
        rows = np.repeat(np.diff(edges) * (2 * math.pi / self.azimuths), self.azimuths)
        return np.append(rows, 2 * math.pi * (1 - edges[-1]))


def hemisphere_of(count: int) -> Hemisphere:
    """The layout of 33, 129, 513 or 2,049 directions.

    Raises:
        KeyError: another number.
    """
    return Hemisphere(*LAYOUTS[count])
