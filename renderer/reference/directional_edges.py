"""Where the directional textures' subject ends, before the sky or before itself: its silhouettes, from the mesh.

Neighbouring rays that meet one piece of surface meet places near either's tangent plane, however it is tilted; where
one part of the subject stands before another, one of the two lies far off the other's plane.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from renderer.reference.directional_mesh import Subject
from renderer.reference.directional_world import Floats

FINER = 3
"""Rays along a pixel's side."""

Rays = Callable[[tuple[float, float]], tuple[Floats, Floats]]


def silhouettes(subject: Subject, rays: Rays, step: float) -> NDArray[np.bool_]:
    """Pixels (H, W) that a silhouette runs through, or between which and the next to the right or below it does.

    Args:
        subject: the triangles. rays: as `renderer.reference.directional.render` takes them.
        step: how far the one part is behind the other at least, across either's surface [m].
    """
    parts = [[subject_seen(subject, rays, ((i + 0.5) / FINER, (j + 0.5) / FINER)) for i in range(FINER)]
             for j in range(FINER)]  # fmt: skip
    height, width = parts[0][0].shape[:2]
    grid = np.zeros((FINER * height, FINER * width, 6))
    for j, row in enumerate(parts):
        for i, part in enumerate(row):
            grid[j::FINER, i::FINER] = part
    found = np.zeros(grid.shape[:2], np.bool_)
    found[:, :-1] |= _parted(grid[:, :-1], grid[:, 1:], step)
    found[:-1] |= _parted(grid[:-1], grid[1:], step)
    return np.asarray(found.reshape(height, FINER, width, FINER).any(axis=(1, 3)))


def subject_seen(subject: Subject, rays: Rays, at: tuple[float, float]) -> Floats:
    """Places and normals (H, W, 6) that the rays of one position meet; not a number where they miss."""
    origins, directions = (np.asarray(part, np.float64) for part in rays(at))
    flat = np.ascontiguousarray(directions.reshape(-1, 3))
    hit, hits = subject.met(np.ascontiguousarray(np.broadcast_to(origins, directions.shape).reshape(-1, 3)), flat)
    found = np.full((len(flat), 6), np.nan)
    found[hit] = np.concatenate([hits.place, hits.normal], axis=1)
    return found.reshape(*directions.shape[:2], 6)


def _parted(one: Floats, other: Floats, step: float) -> NDArray[np.bool_]:
    """Whether two rays' places belong to different pieces, or only one of them meets anything."""
    between = other[..., :3] - one[..., :3]
    off = np.maximum(*(np.abs(np.einsum("...d,...d->...", between, each[..., 3:])) for each in (one, other)))
    met = np.isfinite(one[..., 0]), np.isfinite(other[..., 0])
    return np.asarray((met[0] != met[1]) | (met[0] & met[1] & (np.nan_to_num(off) > step)))
