"""A boulder: broken faces, cracks, strata, and lichen on what looks up."""

from __future__ import annotations

from typing import Literal

import numpy as np
import trimesh

from renderer.core.params import Model, param
from renderer.directional.subject.solid import Solid
from renderer.directional.subject.waves import octaves, waves
from renderer.world.mesh_normals import vertex_normals

STONE, SEAM, LICHEN, MOSS = (np.array(c) for c in ((0.30, 0.27, 0.24), (0.42, 0.33, 0.24), (0.52, 0.50, 0.30),
                                                    (0.10, 0.13, 0.04)))
"""Linear reflectance."""

HALVINGS = 7
"""Of the sides of an icosahedron."""


class Rock(Model):
    """A boulder."""

    kind: Literal["rock"] = "rock"
    size: float = param(2.0, label="Size", help="Of its longest side.", unit="m", cost="bake", gt=0, le=1000)
    seed: int = param(4, label="Seed", help="Another number breaks another rock.", cost="bake", ge=0, le=1_000_000)

    def solid(self) -> Solid:
        """Its triangles."""
        ball = trimesh.creation.icosphere(subdivisions=HALVINGS)
        way, faces = np.asarray(ball.vertices), np.asarray(ball.faces)
        rng = np.random.Generator(np.random.PCG64(self.seed))
        normal = rng.normal(size=(26, 3))
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        away = rng.uniform(0.62, 1.0, 26)
        # The nearest of the broken planes, their edges worn: a soft minimum of where each is met.
        met = np.maximum(way @ normal.T, 1e-3) / away
        radius = (met**18).sum(axis=1) ** (-1 / 18)
        place = way * radius[:, None] * [1.25, 1.0, 0.8]
        place += 0.02 * octaves(place, 0.5, self.seed + 10, 5, 0.55)[:, None] * way
        crack = np.abs(octaves(place, 0.9, self.seed + 30, 3, 0.5))
        place -= (0.05 * np.exp(-((crack / 0.05) ** 2)))[:, None] * way
        height = place[:, 2] + 0.12 * place[:, 0] + 0.02 * waves(place, 0.6, self.seed + 40)
        place[:, :2] *= 1 + 0.012 * np.tanh(4 * np.sin(height * 42))[:, None]
        return Solid(place, faces, self._colour(place, vertex_normals(place, faces))[faces].mean(axis=1))

    def _colour(self, middle: np.ndarray, normal: np.ndarray) -> np.ndarray:
        """Of places (V, 3) that look along normals (V, 3)."""
        height = middle[:, 2] + 0.12 * middle[:, 0] + 0.02 * waves(middle, 0.6, self.seed + 40)
        colour = STONE + (SEAM - STONE) * (0.5 + 0.5 * np.sin(height * 21))[:, None]
        colour = colour * (1 + 0.1 * octaves(middle, 0.12, self.seed + 50, 3))[:, None]
        spots = octaves(middle, 0.22, self.seed + 60, 4, 0.7) + 0.8 * normal[:, 2]
        colour += (LICHEN - colour) * np.clip((spots - 1.1) * 3, 0, 0.85)[:, None]
        damp = octaves(middle, 0.5, self.seed + 70, 4, 0.6) - 1.6 * middle[:, 2] - 0.3
        return np.asarray(colour + (MOSS - colour) * np.clip(damp * 2, 0, 0.9)[:, None])
