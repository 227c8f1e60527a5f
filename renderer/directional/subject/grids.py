"""Faces of rectangular grids of vertices, which several subjects are made of."""

from __future__ import annotations

import numpy as np


def grid_faces(rows: int, columns: int, around: bool = False, along: bool = False) -> np.ndarray:
    """Triangles (F, 3) of a grid of rows x columns vertices, numbered row by row.

    Args:
        around, along: whether the last column, or the last row, meets the first.

    The front is where columns run to the right and rows upwards.
    """
    row, column = np.arange(rows if along else rows - 1)[:, None], np.arange(columns if around else columns - 1)
    above, right = (row + 1) % rows, (column + 1) % columns
    a, b = row * columns + column, row * columns + right
    c, d = above * columns + right, above * columns + column
    return np.stack([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], axis=2).reshape(-1, 3)


def face_middles(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(F, 3) centroids of the faces."""
    return np.asarray(vertices[faces].mean(axis=1))


def joined(parts: list[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of several meshes side by side."""
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in parts[:-1])])
    return (
        np.concatenate([vertices for vertices, _ in parts]),
        np.concatenate([faces + start for (_, faces), start in zip(parts, starts)]),
    )


def welded(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same with vertices at one place, to nine digits of the extent, made one."""
    step = float(np.ptp(vertices, axis=0).max()) * 1e-9
    _, first, number = np.unique(np.rint(vertices / step).astype(np.int64), axis=0, return_index=True,
                                 return_inverse=True)
    return vertices[first], number.reshape(-1)[faces]
