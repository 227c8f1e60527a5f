"""The teapot as a surface for shells: its patches with texture coordinates."""

from __future__ import annotations

import numpy as np

from renderer.shells.base_mesh import BaseMesh, from_corners, side_by_side
from renderer.shells.surface_grids import arc_lengths, turned_corners, wrapped_corners
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


def teapot(size: float, detail: int, repeat_u: int, repeat_v: float) -> BaseMesh:
    """The teapot, its box centred at the origin.

    Args:
        size: from the handle to the spout's mouth, m.
        detail: 1 gives 2,142 triangles; cells of each side are cut into that many.
        repeat_u, repeat_v: how often the texture stands around the body and up it. Lid, handle and spout have whole
            numbers of it around, and as much of it along as keeps its proportions.
    """
    parts = []
    texel = np.array([0.0, 0.0])  # lengths of one repeat around and along
    for profile, (around, cells) in ((BODY, BODY_CELLS), (LID, LID_CELLS)):
        grid = nodes(quarters(profile), along(cells, detail), around * detail)
        curve = np.stack([np.hypot(*grid[:, 0, :2].T), grid[:, 0, 2]], axis=-1)
        length, girth = _length(curve), 2 * np.pi * curve[:, 0].max()
        if not texel.any():
            texel = np.array([girth / repeat_u, length / repeat_v])
        times = max(round(girth / texel[0]), 1)
        parts.append(turned_corners(grid, times, arc_lengths(curve) * length / texel[1]))
    for rows, (around, count) in ((HANDLE, HANDLE_CELLS), (SPOUT, SPOUT_CELLS)):
        grid = nodes(sections(rows), np.arange(count * detail + 1) / (count * detail) * 2, around * detail)
        spine = grid[:, :-1].mean(axis=1)
        girth = max(_length(section) for section in grid)
        times = max(round(girth / texel[0]), 1)
        parts.append(wrapped_corners(grid, times, arc_lengths(spine) * _length(spine) / texel[1]))
    low = np.min([corner.min(axis=(0, 1)) for corner, _ in parts], axis=0)
    high = np.max([corner.max(axis=(0, 1)) for corner, _ in parts], axis=0)
    scale = size / (high - low)[0]
    return side_by_side([from_corners((corner - (low + high) / 2) * scale, uv) for corner, uv in parts])


def _length(curve: np.ndarray) -> float:
    return float(np.linalg.norm(np.diff(curve, axis=0), axis=1).sum())
