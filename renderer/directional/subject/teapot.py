"""Newell's teapot, glazed and painted."""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.params import Model, param
from renderer.directional.subject.grids import face_middles, grid_faces, joined, welded
from renderer.directional.subject.solid import Solid
from renderer.world.teapot import (
    BODY,
    BODY_CELLS,
    HANDLE,
    HANDLE_CELLS,
    LID,
    LID_CELLS,
    SPOUT,
    SPOUT_CELLS,
    along,
    nodes,
    quarters,
    sections,
)

FINER = {"body": 11, "lid": 5, "handle": 6, "spout": 8}
"""Into how many each side of the usual cells is cut: paint is seen by the triangle."""

GLAZE, BLUE, DARK = np.array([0.74, 0.71, 0.64]), np.array([0.05, 0.11, 0.36]), np.array([0.12, 0.10, 0.08])
"""Linear reflectance of the ground, the paint and what lies inside."""

BANDS = ((0.22, 0.30), (0.36, 0.40), (1.86, 1.92), (2.0, 2.1), (2.46, 2.6))
"""Heights of painted rings."""


class Teapot(Model):
    """Newell's teapot."""

    kind: Literal["teapot"] = "teapot"
    size: float = param(
        2.0, label="Size", help="From the handle to the spout's mouth.", unit="m", cost="bake", gt=0, le=1000,
        source="Newell 1975",
    )

    def solid(self) -> Solid:
        """Its triangles, with a floor under the gap around its lid and in its spout."""
        parts = []
        for name, profile, (around, cells) in (("body", BODY, BODY_CELLS), ("lid", LID, LID_CELLS)):
            parts.append(_closed(nodes(quarters(profile), along(cells, FINER[name]), around * FINER[name])))
        for name, rows, (around, count) in (("handle", HANDLE, HANDLE_CELLS), ("spout", SPOUT, SPOUT_CELLS)):
            places = np.arange(count * FINER[name] + 1) / (count * FINER[name]) * 2
            parts.append(_closed(nodes(sections(rows), places, around * FINER[name])))
        ring = SPOUT_CELLS[0] * FINER["spout"]
        mouth = parts[-1][0][-8 * ring:][:ring]
        turn = np.arange(48) * (2 * np.pi / 48)
        inside = np.stack([1.405 * np.cos(turn), 1.405 * np.sin(turn), np.full(48, 2.4)], axis=1)
        painted = [_paint(*part) for part in parts]
        parts += [_disc(inside), _disc(mouth)]
        vertices, faces = welded(*joined(parts))
        dark = np.repeat(DARK[None], len(faces) - sum(map(len, painted)), axis=0)
        return Solid(vertices, faces, np.concatenate([*painted, dark]))


def _closed(grid: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of a grid (R, C + 1, 3) whose last column is its first."""
    rows, columns = grid.shape[0], grid.shape[1] - 1
    return grid[:, :-1].reshape(-1, 3), grid_faces(rows, columns, around=True)


def _disc(ring: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A fan over a ring of places, seen from where it runs counter-clockwise."""
    number = np.arange(len(ring))
    faces = np.stack([number, (number + 1) % len(ring), np.full(len(ring), len(ring))], axis=1)
    return np.concatenate([ring, ring.mean(axis=0, keepdims=True)]), faces


def _paint(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Rings, and flowers with a stem between them, (F, 3)."""
    x, y, z = face_middles(vertices, faces).T
    ring = np.any([(z > low) & (z < high) for low, high in BANDS], axis=0)
    turn = np.arctan2(y, x) * 9 / (2 * np.pi)
    across, up = (turn - np.floor(turn) - 0.5) * 1.3, z - 1.25
    leaf = np.abs(across) * 4 < np.sin(np.clip((z - 0.45) / 0.5, 0, 1) * np.pi)
    angle, away = np.arctan2(up, across), np.hypot(across, up)
    petals = away < 0.32 * (0.55 + 0.45 * np.abs(np.cos(2.5 * angle)))
    flower = petals & ~((away > 0.07) & (away < 0.11))
    stem = (np.abs(across - 0.06 * np.sin(6 * z)) < 0.018) & (z > 0.5) & (z < 1.1)
    outside = np.hypot(x, y) > 1.0
    painted = ring | (outside & (leaf | flower | stem) & (z > 0.45) & (z < 1.8))
    return np.where(painted[:, None], BLUE, GLAZE)
