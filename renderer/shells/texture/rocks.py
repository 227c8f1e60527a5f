"""Stones side by side: figure 6.5 of Dufort 2005.

Each stone is a cell around a scattered point (Worley 1996): its height follows the distance to the border with the
next cell, the difference of the distances to the nearest two points.
"""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np
from scipy.spatial import cKDTree

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.noise import noise
from renderer.shells.texture.raised import under
from renderer.shells.texture.source import Procedure, generator, wrapped


class Rocks(Procedure):
    """Stones."""

    seconds: ClassVar[float] = 2.0
    kind: Literal["rocks"] = "rocks"
    across: int = param(
        512, label="Voxels across", help="Along each side of the repeated square.", unit="voxel", cost="bake",
        ge=8, le=512, source="Dufort 2005, table 6.1",
    )
    seed: int = param(2, label="Seed", help="Of the stones' places.", cost="bake", ge=0, le=2**31 - 1)
    stones: int = param(
        12, label="Stones", help="Along each side of the repeated square.", unit="count", cost="bake", ge=2, le=64
    )
    roughness: float = param(
        0.35, label="Roughness", help="Of the stones' surface.", unit="ratio", cost="bake", ge=0, le=1, step=0.05
    )
    stone: Colour = param((0.34, 0.31, 0.27), label="Stone", help="Mean reflectance of the stones.", cost="bake")
    moss: Colour = param((0.1, 0.13, 0.05), label="Moss", help="Reflectance of what grows between them.", cost="bake")

    def matter(self) -> Matter:
        """Opaque down to the base surface."""
        rng = generator(self.seed)
        grid = np.stack(np.meshgrid(*[np.arange(self.stones)] * 2), axis=-1).reshape(-1, 2)
        pitch = self.side / self.stones
        places = (grid + 0.5 + rng.uniform(-0.38, 0.38, grid.shape)) * pitch
        tall, shade = rng.uniform(0.55, 1.0, len(places)), rng.uniform(0.65, 1.3, len(places))
        tilt = rng.normal(0.0, 0.22, (len(places), 2))
        warm = 1.0 + rng.normal(0.0, 0.025, (len(places), 3))
        x, y = self.centres()[0][0], self.centres()[1][0]
        coarse = [noise(rng, x, y, np.zeros(1), self.side, 2 * self.stones, 2) for _ in range(2)]
        at = np.stack([(x + 0.12 * pitch * coarse[0]), (y + 0.12 * pitch * coarse[1])], axis=-1).reshape(-1, 2)
        distance, nearest = cKDTree(places % self.side, boxsize=self.side).query(at % self.side, k=2)
        square = (self.across, self.across)
        border = ((distance[:, 1] - distance[:, 0]) / pitch).reshape(square)
        own = nearest[:, 0].reshape(square)
        away = wrapped(at - (places % self.side)[nearest[:, 0]], self.side).reshape(*square, 2)
        fine = noise(rng, x, y, np.zeros(1), self.side, 3 * self.stones, 4)
        # A rounded edge that rises over a quarter of the pitch, then a flat and tilted top.
        rise = np.clip(border / 0.5, 0.0, 1.0)
        dome = np.sqrt(1.0 - (1.0 - rise) ** 2)
        height = 0.1 + 0.78 * dome * (tall[own] + (tilt[own] * away / pitch).sum(axis=-1))
        height = np.clip(height + 0.16 * self.roughness * fine * (0.3 + dome), 0.03, 0.97)
        tint = np.asarray(self.stone) * warm[own] * (shade[own] * (1.0 + 0.5 * fine))[..., None]
        grown = np.clip(1.6 - 4.0 * dome + 0.8 * fine, 0.0, 1.0)[..., None]
        return under(self, height, tint * (1 - grown) + np.asarray(self.moss) * grown)
