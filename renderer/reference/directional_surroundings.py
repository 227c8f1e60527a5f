"""Light from a picture of all directions: what a mirror sees in it, and what it sends to a plane."""

from __future__ import annotations

import math

import numpy as np

from renderer.reference.directional_world import Floats

FINEST = (64, 128)
"""Most rows and columns of the picture whose light on a plane is summed; finer ones are first averaged by solid angle.
A cell of 2.8 degrees stands for its light at its middle: 1e-4 of the cosine."""

PLANES = (61, 120)
"""Polar angles and azimuths of the planes for which it is summed; in between it is interpolated, which errs by 4e-4 of
a light from one point."""


class Picture:
    """An equirectangular picture, row 0 at the zenith, columns by azimuth clockwise from north.

    Args:
        image: (H, W, 3) radiance. rotation: clockwise about the zenith [rad].
    """

    def __init__(self, image: Floats, rotation: float) -> None:
        self.image = np.asarray(image, np.float64)
        self.rotation = rotation
        self._sent: Floats | None = None

    def radiance(self, directions: Floats) -> Floats:
        """(M, 3) from unit directions (M, 3), bilinear between texels; W m-2 sr-1."""
        height, width = self.image.shape[:2]
        across = (self._azimuth(directions) / (2 * math.pi) * width - 0.5) % width
        down = np.clip(_polar(directions) / math.pi * height - 0.5, 0, height - 1)
        return _bilinear(self.image, down, across)

    def irradiance(self, normals: Floats) -> Floats:
        """(M, 3) on planes that face unit normals (M, 3), W m-2."""
        if self._sent is None:
            self._sent = _sent(self.image)
        rows, columns = PLANES
        across = self._azimuth(normals) / (2 * math.pi) * columns % columns
        return _bilinear(self._sent, _polar(normals) / math.pi * (rows - 1), across)

    def _azimuth(self, directions: Floats) -> Floats:
        """In the picture, clockwise from its own north [rad]."""
        return np.asarray(np.arctan2(directions[:, 0], directions[:, 1]) - self.rotation)


def _polar(directions: Floats) -> Floats:
    return np.asarray(np.arccos(np.clip(directions[:, 2], -1, 1)))


def _bilinear(image: Floats, down: Floats, across: Floats) -> Floats:
    """Between centres at whole numbers; closed from left to right."""
    height, width = image.shape[:2]
    i, j = np.minimum(np.floor(down).astype(int), max(height - 2, 0)), np.floor(across).astype(int) % width
    v, u = (down - i)[:, None], (across - np.floor(across))[:, None]
    below, right = np.minimum(i + 1, height - 1), (j + 1) % width
    upper, lower = ((1 - u) * image[row, j] + u * image[row, right] for row in (i, below))
    return np.asarray((1 - v) * upper + v * lower)


def _sent(image: Floats) -> Floats:
    """Irradiance on the planes of `PLANES`, (rows, columns, 3): every texel's light by its solid angle and cosine."""
    height, width = image.shape[:2]
    edges = np.cos(np.linspace(0, math.pi, height + 1))
    solid = (edges[:-1] - edges[1:])[:, None, None] * (2 * math.pi / width)
    light = _fewer(image * solid, FINEST)
    # where the solid angle of a cell has its middle
    cells = np.cos(np.linspace(0, math.pi, len(light) + 1))
    towards = _directions(np.arccos((cells[:-1] + cells[1:]) / 2), (np.arange(light.shape[1]) + 0.5) / light.shape[1])
    planes = _directions(np.linspace(0, math.pi, PLANES[0]), np.arange(PLANES[1]) / PLANES[1]).reshape(-1, 3)
    flat, sources = light.reshape(-1, 3), towards.reshape(-1, 3)
    lit = np.any(flat != 0, axis=1)
    parts = [np.maximum(part @ sources[lit].T, 0) @ flat[lit] for part in np.array_split(planes, 64)]
    return np.concatenate(parts).reshape(*PLANES, 3)


def _fewer(light: Floats, most: tuple[int, int]) -> Floats:
    """Sums over equal blocks, so that at most so many rows and columns are left."""
    for axis, limit in enumerate(most):
        count = light.shape[axis]
        block = next(n for n in range(1, count + 1) if count % n == 0 and count // n <= limit)
        shape = (*light.shape[:axis], count // block, block, *light.shape[axis + 1 :])
        light = light.reshape(shape).sum(axis=axis + 1)
    return light


def _directions(polar: Floats, turns: Floats) -> Floats:
    """(rows, columns, 3) unit vectors by polar angle and share of a turn clockwise from north."""
    theta, azimuth = np.meshgrid(polar, 2 * math.pi * turns, indexing="ij")
    return np.stack([np.sin(theta) * np.sin(azimuth), np.sin(theta) * np.cos(azimuth), np.cos(theta)], axis=-1)
