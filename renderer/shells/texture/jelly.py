"""Opaque balls in semi-transparent jelly: figure 6.1's volumetric shadows."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.source import Procedure, generator, mixed, unit, with_glow

TRIES = 4000
"""Places tried for balls before no more are looked for."""


class Jelly(Procedure):
    """Balls in jelly."""

    kind: Literal["jelly"] = "jelly"
    seed: int = param(4, label="Seed", help="Of the balls' places and sizes.", cost="bake", ge=0, le=2**31 - 1)
    balls: int = param(
        60, label="Balls", help="In the repeated square, as far as there is room.", unit="count", cost="bake",
        ge=1, le=500,
    )
    radius: float = param(
        0.2, label="Radius", help="Of the largest balls, against the thickness.", unit="ratio", cost="bake",
        ge=0.02, le=0.5, step=0.01,
    )
    ball: Colour = param((0.85, 0.8, 0.7), label="Balls' colour", help="Reflectance of the balls.", cost="bake")
    jelly: Colour = param((0.75, 0.03, 0.02), label="Jelly's colour", help="Reflectance of the jelly.", cost="bake")
    optical_depth: float = param(
        1.2, label="Optical depth", help="Of the jelly along the shell's thickness.", cost="bake", ge=0, le=8
    )
    glowing: float = param(
        0.0, label="Glowing balls", help="Share of the balls that send out light.", unit="ratio", cost="bake", ge=0,
        le=1, step=0.05, source="Dufort 2005, section 5.3.1",
    )
    second_opacity: float = param(
        1.0, label="Opacity of the jelly", help="Factor on the jelly's own.", unit="ratio", cost="host", ge=0, le=1,
        source="Dufort 2005, figure 5.13",
    )

    def matter(self) -> Matter:
        """Balls are the first material, with normals; the jelly is the second and has none. The smallest balls glow."""
        centre, radius = self._balls()
        # Surfaces of unequal balls: the nearest one is sought among the nearest few centres.
        few = min(4, len(centre))
        box = np.array([self.side, self.side, 0.0])
        distance, nearest = cKDTree(centre, boxsize=box).query(self.points(), k=np.arange(1, few + 1))
        surface = distance - radius[nearest]
        first = surface.argmin(axis=1)[:, None]
        surface = np.take_along_axis(surface, first, 1)[:, 0].reshape(self.shape)
        nearest = np.take_along_axis(nearest, first, 1)[:, 0]
        away = self.points() - centre[nearest]
        away[:, :2] -= self.side * np.round(away[:, :2] / self.side)
        cover = self.covered(surface)
        thin = np.float32(-np.expm1(-self.optical_depth / self.layers))
        colour = mixed((thin * (1 - cover), self.jelly), (cover, self.ball))
        normal = unit(away).reshape(*self.shape, 3) * (cover > 0)[..., None]
        lit = np.arange(len(centre)) >= round((1.0 - self.glowing) * len(centre))
        glow = lit[nearest].reshape(self.shape) * cover
        return Matter(colour, with_glow(normal, glow), np.where(cover > 0.05, 1, 2).astype(np.uint8))

    def _balls(self) -> tuple[np.ndarray, np.ndarray]:
        """Centres (N, 3) and radii (N,) of balls that do not meet, largest first, where the height is 1."""
        rng = generator(self.seed)
        radii = np.sort(self.radius * rng.uniform(0.5, 1.0, self.balls))[::-1]
        centres: list[np.ndarray] = []
        kept: list[float] = []
        for _ in range(TRIES):
            if len(kept) == self.balls:
                break
            radius = float(radii[len(kept)])
            at = rng.uniform([0, 0, radius], [self.side, self.side, 1 - radius])
            apart = np.array(centres).reshape(-1, 3) - at
            apart[:, :2] -= self.side * np.round(apart[:, :2] / self.side)
            if (np.linalg.norm(apart, axis=1) > np.array(kept) + radius + 0.02).all():
                centres.append(at)
                kept.append(radius)
        return np.array(centres), np.array(kept)
