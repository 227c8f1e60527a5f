"""A knot of twisted rope: strands that wind about a torus knot, and shadow themselves and one another."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from renderer.core.params import Model, param
from renderer.directional.subject.grids import grid_faces
from renderer.directional.subject.solid import Solid

ROPE = 0.46
"""Radius of the rope, where the knot's own tube has 1 and goes round the axis at 2."""

PALETTE = np.array([(0.55, 0.33, 0.13), (0.16, 0.30, 0.42), (0.62, 0.55, 0.42)])
"""Linear reflectance of the strands, in turn."""


class Knot(Model):
    """A torus knot of rope."""

    kind: Literal["knot"] = "knot"
    size: float = param(2.0, label="Size", help="Of its longest side.", unit="m", cost="bake", gt=0, le=1000)
    turns: int = param(2, label="Turns", help="About the axis.", cost="bake", ge=1, le=9)
    loops: int = param(3, label="Loops", help="Through the middle.", cost="bake", ge=1, le=9)
    strands: int = param(3, label="Strands", help="Of the rope.", cost="bake", ge=1, le=12)
    twist: int = param(14, label="Twist", help="How often the rope turns in all.", cost="bake", ge=0, le=64)

    def solid(self) -> Solid:
        """Its triangles."""
        along, around = 1500, 60
        t = 2 * math.pi * np.arange(along) / along
        ring = 2 + np.cos(self.loops * t)
        curve = np.stack([ring * np.cos(self.turns * t), ring * np.sin(self.turns * t), np.sin(self.loops * t)], axis=1)
        ahead = _unit(np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0))
        out = _unit(curve - np.stack([2 * np.cos(self.turns * t), 2 * np.sin(self.turns * t), 0 * t], axis=1))
        aside = _unit(np.cross(ahead, out))
        out = np.cross(aside, ahead)
        angle = 2 * math.pi * np.arange(around) / around
        phase = self.strands * angle + self.strands * self.twist * t[:, None] / math.gcd(self.turns, self.loops)
        radius = ROPE * (0.8 + 0.2 * np.sqrt(np.abs(np.cos(phase / 2))))
        fibres = 1 + 0.012 * np.sin(7 * phase + 5 * angle)
        section = np.cos(angle)[:, None] * out[:, None] + np.sin(angle)[:, None] * aside[:, None]
        vertices = (curve[:, None] + (radius * fibres)[..., None] * section).reshape(-1, 3)
        faces = grid_faces(along, around, around=True, along=True)
        strand = np.floor(phase / (2 * math.pi) + 0.5).astype(int).reshape(-1) % min(self.strands, len(PALETTE))
        worn = 0.75 + 0.25 * (radius / ROPE).reshape(-1) ** 6
        colour = PALETTE[strand] * worn[:, None]
        return Solid(vertices, faces, colour[faces[:, 0]])


def _unit(vectors: np.ndarray) -> np.ndarray:
    length: np.ndarray = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / length
