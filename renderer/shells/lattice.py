"""Rays of some of a picture's pixels, in columns and rows of their own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

STEPS = (("camera_origin", "camera_origin_dx", "camera_origin_dy"), ("camera_corner", "camera_dx", "camera_dy"))
"""Uniforms of where rays start and where they go: at the picture's corner, and how it changes from pixel to pixel."""


@dataclass(frozen=True)
class Lattice:
    """Where rays are.

    Attributes:
        picture: its (width, height) in pixels.
        size: number of columns and of rows.
        first: where the ray of the first column and row is, pixels from the picture's top-left corner.
        column, row: from a ray to that of the next column, and to that of the next row, pixels.
    """

    picture: tuple[int, int]
    size: tuple[int, int]
    first: tuple[float, float]
    column: tuple[float, float]
    row: tuple[float, float]

    def uniforms(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Those of the picture's rays, for these."""
        found: dict[str, Any] = {"picture_size": self.size, "pixel_offset": (0.0, 0.0)}
        for start, across, down in STEPS:
            dx, dy = np.asarray(values[across]), np.asarray(values[down])
            for name, (x, y) in ((across, self.column), (down, self.row)):
                found[name] = tuple(x * dx + y * dy)
            found[start] = tuple(np.asarray(values[start]) + self.first[0] * dx + self.first[1] * dy)
        return found

    def projection(self, whole: np.ndarray) -> np.ndarray:
        """(4, 4) from metres to clip coordinates of these rays, of that to those of the picture's pixels' middles."""
        width, height = self.picture
        pixels = np.array([[width / 2, 0, 0, width / 2], [0, -height / 2, 0, height / 2]]) @ whole
        pixels -= np.outer(np.subtract(self.first, np.add(self.column, self.row) / 2), whole[3])
        columns, rows = np.linalg.solve(np.transpose([self.column, self.row]), pixels)
        across, down = self.size
        return np.stack([2 * columns / across - whole[3], whole[3] - 2 * rows / down, whole[2], whole[3]])

    def sides(self, whole: np.ndarray) -> tuple[np.ndarray, ...]:
        """Planes (4,) between which the picture lies, where rows slant and lead out of it; `whole` as above."""
        return (whole[3] + whole[0], whole[3] - whole[0]) if self.row[0] else ()


def every_fourth(picture: tuple[int, int], offset: tuple[float, float]) -> Lattice:
    """A ray for two by two pixels, between them where the `offset` of a sample in its pixel is its middle."""
    size = (-(-picture[0] // 2), -(-picture[1] // 2))
    return Lattice(picture, size, (0.5 + offset[0], 0.5 + offset[1]), (2.0, 0.0), (0.0, 2.0))


def every_second(picture: tuple[int, int], offset: tuple[float, float]) -> Lattice:
    """A ray for every second pixel, as the white squares of a chessboard: rows slant, and begin before the picture."""
    before = picture[1] // 2
    size = (before + -(-picture[0] // 2), picture[1])
    return Lattice(picture, size, (offset[0] - 2 * before, offset[1]), (2.0, 0.0), (1.0, 1.0))
