"""A basket: rods woven over and under stakes, with gaps that light falls through."""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.params import Model, param
from renderer.directional.subject.grids import grid_faces, joined
from renderer.directional.subject.solid import Solid
from renderer.world.tree import tubes

SIDES = 8
"""Of a rod's section."""

HEIGHT = 0.95
PALETTE = np.array([(0.46, 0.30, 0.13), (0.40, 0.25, 0.10), (0.52, 0.37, 0.18), (0.34, 0.20, 0.09)])
DYED = np.array([0.10, 0.20, 0.17])
"""Linear reflectance of rods, and of the dyed rows."""


def _girth(height: np.ndarray) -> np.ndarray:
    """Radius of the basket by its height."""
    share = height / HEIGHT
    return np.asarray(0.62 + 0.34 * np.sin(share * 2.0) - 0.03 * share)


class Basket(Model):
    """A round basket with a handle."""

    kind: Literal["basket"] = "basket"
    size: float = param(2.0, label="Size", help="Of its longest side.", unit="m", cost="bake", gt=0, le=1000)
    stakes: int = param(32, label="Stakes", help="That rods are woven around.", cost="bake", ge=6, le=96)
    rows: int = param(22, label="Rows", help="Of rods, one over the other.", cost="bake", ge=3, le=80)

    def solid(self) -> Solid:
        """Its triangles."""
        pitch = HEIGHT / self.rows
        thick = 0.46 * pitch
        parts, colours = [], []

        def add(part: tuple[np.ndarray, np.ndarray], colour: np.ndarray) -> None:
            parts.append(part)
            colours.append(np.repeat(colour[None], len(part[1]), axis=0))

        turn = np.arange(self.stakes * 8) * (2 * np.pi / (self.stakes * 8))
        for row in range(self.rows):
            sway = np.cos(self.stakes * turn / 2 + np.pi * row)
            way = (row + 0.5) * pitch
            add(_hoop(turn, _girth(np.full(len(turn), way)) + 1.15 * thick * sway, np.full(len(turn), way), thick),
                DYED if row % 9 in (5, 6) else PALETTE[row * 7 % 4])
        for count, lift in ((3, 0.0), (3, np.pi / 3 * 2), (3, np.pi / 3 * 4)):
            wind = self.stakes / count * turn + lift
            add(_hoop(turn, _girth(np.full(len(turn), HEIGHT)) + thick * np.cos(wind),
                      HEIGHT + 0.4 * thick + thick * np.sin(wind), 0.8 * thick), PALETTE[2])
        for part, colour in (self._stakes(thick), self._floor(thick), self._handle(thick)):
            add(part, colour)
        vertices, faces = joined(parts)
        return Solid(vertices, faces, np.concatenate(colours))

    def _stakes(self, thick: float) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray]:
        angle = (np.arange(self.stakes) * 2 + 1) * (np.pi / self.stakes)
        height = np.linspace(0, HEIGHT, 60)
        # A stake stands on the circle that rods cross between going out and coming in.
        axis = np.stack(np.broadcast_arrays(_girth(height) * np.cos(angle)[:, None],
                                            _girth(height) * np.sin(angle)[:, None], height), axis=-1)
        return tubes(axis, np.full(axis.shape[:2], 0.9 * thick), SIDES), PALETTE[3]

    def _floor(self, thick: float) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray]:
        """Rods wound in a spiral around the middle of the bottom."""
        most = float(_girth(np.zeros(1))[0])
        turns = int(most / (1.9 * thick))
        t = np.linspace(0.4, turns, 40 * turns)
        radius = most * t / turns
        height = thick + 0.5 * thick * np.cos(9 * np.pi * t)
        axis = np.stack([radius * np.cos(2 * np.pi * t), radius * np.sin(2 * np.pi * t), height], axis=1)
        return tubes(axis[None], np.full((1, len(t)), thick), SIDES), PALETTE[1]

    def _handle(self, thick: float) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray]:
        """Three rods twisted around an arch."""
        t = np.linspace(-0.12, 1.12, 260)
        bend = np.pi * t
        radius = float(_girth(np.array([HEIGHT]))[0])
        arch = np.stack([-radius * np.cos(bend), 0 * t, HEIGHT * 0.92 + 0.95 * np.sin(bend)], axis=1)
        out = np.stack([-np.cos(bend), 0 * t, np.sin(bend)], axis=1)
        rods = []
        for k in range(3):
            wind = 16 * np.pi * t + 2 * np.pi * k / 3
            rods.append(arch + 1.3 * thick * (np.cos(wind)[:, None] * out + np.sin(wind)[:, None] * [0, 1, 0]))
        return tubes(np.stack(rods), np.full((3, len(t)), 1.15 * thick), SIDES), PALETTE[0]


def _hoop(turn: np.ndarray, radius: np.ndarray, height: np.ndarray, thick: float) -> tuple[np.ndarray, np.ndarray]:
    """A closed rod through places by azimuth, distance from the axis and height."""
    axis = np.stack([radius * np.cos(turn), radius * np.sin(turn), height], axis=1)
    ahead = np.roll(axis, -1, axis=0) - np.roll(axis, 1, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    out = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    above = np.cross(out, ahead)
    above /= np.linalg.norm(above, axis=1, keepdims=True)
    out = np.cross(ahead, above)
    angle = np.arange(SIDES) * (2 * np.pi / SIDES)
    ring = np.cos(angle)[:, None] * out[:, None] + np.sin(angle)[:, None] * above[:, None]
    faces = grid_faces(len(turn), SIDES, around=True, along=True)[:, ::-1]
    return (axis[:, None] + thick * ring).reshape(-1, 3), faces
