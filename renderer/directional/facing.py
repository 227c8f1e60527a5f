"""Which faces a camera sees, and which directions their texels need."""

from __future__ import annotations

from typing import Any

import numpy as np

from renderer.directional.casting import AXES, face_frame, face_middles
from renderer.directional.hemisphere import Hemisphere
from renderer.world.camera import Orthographic, pose

GRID, NEAR_GRID = 33, 65
"""Places along a face's side at which directions are looked at; the latter within half a side of it, where they turn
faster from place to place."""


def side(face: int) -> float:
    """1 where a face's outward normal runs along its axis, -1 where against it."""
    return 1.0 if face % 2 else -1.0


def faces_seen(camera: Any, box: np.ndarray) -> list[int]:
    """The faces whose outer side the camera sees, at most three."""
    at = pose(camera)
    seen = []
    for face in range(6):
        axis = AXES[face][2]
        plane = box[face % 2, axis]
        ahead = -at.forward[axis] if isinstance(camera, Orthographic) else at.eye[axis] - plane
        if side(face) * ahead > 0:
            seen.append(face)
    return seen


def directions_needed(camera: Any, face: int, box: np.ndarray, layout: Hemisphere) -> np.ndarray:
    """Numbers of the directions of a face's hemisphere from which its texels may be asked: those round each direction
    that a texel is seen from, with one more on every side, since a pixel's ray comes from between them."""
    at = pose(camera)
    axis = AXES[face][2]
    near = abs(at.eye[axis] - box[face % 2, axis]) < np.ptp(box, axis=0).max() / 2
    away = face_middles(box, face, NEAR_GRID if near else GRID)
    to_eye = -at.forward[None] if isinstance(camera, Orthographic) else at.eye - away
    u, v, out = (to_eye @ face_frame(face).T).T
    row = np.floor(np.arctan2(np.maximum(out, 0), np.hypot(u, v)) / layout.step - 0.5).astype(int)
    azimuth = np.floor(np.arctan2(v, u) / (2 * np.pi) * layout.azimuths).astype(int) % layout.azimuths
    # Rows from one below the lowest, azimuths once around and again: what lies round a mark is then found by shifting.
    marked = np.zeros((layout.elevations + 2, layout.azimuths), bool)
    marked[row + 1, azimuth] = True
    marked = np.logical_or.reduce([np.roll(marked, across, axis=1) for across in range(-1, 3)])
    needed = np.zeros((layout.elevations + 1, layout.azimuths), bool)
    for up in range(-1, 3):
        to = np.clip(np.arange(-1, layout.elevations + 1) + up, 0, layout.elevations)
        np.logical_or.at(needed, to, marked)
    if row.max() + 2 >= layout.elevations:  # round the zenith, azimuths between two texels may be any
        needed[-4:] = True
    rows, azimuths = np.nonzero(needed[:-1])
    found = rows * layout.azimuths + azimuths
    return np.append(found, layout.count - 1) if needed[-1].any() else found
