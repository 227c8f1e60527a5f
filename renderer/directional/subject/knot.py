"""A knot of twisted rope: strands that wind about a torus knot, and shadow themselves and one another."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from renderer.core.params import Model, param
from renderer.directional.subject.grids import grid_faces, joined
from renderer.directional.subject.solid import Solid
from renderer.world.tree import Part

ROPE = 0.46
"""Radius of the rope, where the knot's own tube has 1 and goes round the axis at 2."""

ALONG, AROUND = 1500, 60
"""Cells of a rope."""

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
        """Its triangles; of turns and loops with a common divisor, as many ropes as that is."""
        ropes = math.gcd(self.turns, self.loops)
        parts, colours = [], []
        for rope in range(ropes):
            part, worn = self._rope(self.turns // ropes, self.loops // ropes, 2 * math.pi * rope / ropes, ropes)
            parts.append(part)
            colours.append(worn)
        vertices, faces = joined(parts)
        return Solid(vertices, faces, np.concatenate(colours))

    def _rope(self, turns: int, loops: int, lead: float, ropes: int) -> tuple[Part, np.ndarray]:
        """Vertices and faces of one rope, whose loops are `lead` [rad] ahead; colours of the faces."""
        along, around = ALONG // ropes, AROUND // self.strands * self.strands
        t = 2 * math.pi * np.arange(along) / along
        ring = 2 + np.cos(loops * t + lead)
        core = 2 * np.stack([np.cos(turns * t), np.sin(turns * t), 0 * t], axis=1)
        curve = ring[:, None] * core / 2 + np.stack([0 * t, 0 * t, np.sin(loops * t + lead)], axis=1)
        ahead = _unit(np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0))
        aside = _unit(np.cross(ahead, curve - core))
        out = np.cross(aside, ahead)
        # The grid turns with the strands, so that they end along its lines.
        phase = 2 * math.pi * self.strands * (np.arange(around) + 0.5) / around
        angle = phase / self.strands - -(-self.twist // ropes) * t[:, None]
        fibres = 0.01 * np.sin(4 * phase + 260 // ropes * t[:, None])
        radius = ROPE * (0.78 + 0.22 * np.sqrt(np.abs(np.sin(phase / 2)))) * (1 + fibres)
        section = np.cos(angle)[..., None] * out[:, None] + np.sin(angle)[..., None] * aside[:, None]
        vertices = (curve[:, None] + radius[..., None] * section).reshape(-1, 3)
        faces = grid_faces(along, around, around=True, along=True)
        column = np.tile(np.repeat(np.arange(around), 2), along)
        strand = (column * self.strands // around) % min(self.strands, len(PALETTE))
        return (vertices, faces), PALETTE[strand] * (0.5 + 0.5 * radius.reshape(-1)[faces].mean(axis=1) / ROPE)[:, None]


def _unit(vectors: np.ndarray) -> np.ndarray:
    length: np.ndarray = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / length
