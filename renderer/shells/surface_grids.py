"""Surfaces made of grids: planes, tubes, spheres, and curves turned around an axis."""

from __future__ import annotations

import math

import numpy as np

from renderer.shells.base_mesh import BaseMesh, from_corners, side_by_side


def grid_corners(nodes: np.ndarray, uv: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of the triangles of a grid, two to a cell.

    Args:
        nodes: (R + 1, C + 1, 3) positions; the front is where x along columns and y along rows are seen from +z.
        uv: (R + 1, C + 1, 2) texture coordinates of the nodes.

    Returns:
        corners (2 R C, 3, 3) and their texture coordinates (2 R C, 3, 2).
    """
    def cut(values: np.ndarray) -> np.ndarray:
        a, b, c, d = values[:-1, :-1], values[:-1, 1:], values[1:, 1:], values[1:, :-1]
        triangles = np.stack([np.stack([a, b, c], axis=2), np.stack([a, c, d], axis=2)], axis=2)
        return triangles.reshape(-1, 3, values.shape[-1])

    return cut(nodes), cut(uv)


def grid_uv(rows: int, columns: int, repeat_u: float, repeat_v: float) -> np.ndarray:
    """Texture coordinates of a grid's nodes, (rows + 1, columns + 1, 2)."""
    u, v = np.meshgrid(np.arange(columns + 1) / columns * repeat_u, np.arange(rows + 1) / rows * repeat_v)
    return np.stack([u, v], axis=-1)


def plane(size: float, divisions: int, repeat_u: float, repeat_v: float) -> BaseMesh:
    """A square of side `size` [m] in z = 0 around the origin, cut into divisions x divisions cells."""
    along = (np.arange(divisions + 1) / divisions - 0.5) * size
    x, y = np.meshgrid(along, along)
    nodes = np.stack([x, y, np.zeros_like(x)], axis=-1)
    return from_corners(*grid_corners(nodes, grid_uv(divisions, divisions, repeat_u, repeat_v)))


def wrapped_corners(nodes: np.ndarray, repeat_u: float, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a grid that closes around, as `grid_corners` gives them, its front outside.

    Args:
        nodes: (R + 1, C + 1, 3), the last column the first again.
        repeat_u: how often the texture repeats around. heights: (R + 1,) v along.
    """
    uv = grid_uv(len(nodes) - 1, nodes.shape[1] - 1, repeat_u, 1.0)
    uv[..., 1] = heights[:, None]
    return grid_corners(nodes, uv)


def turned_corners(nodes: np.ndarray, repeat_u: float, heights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same around the z axis, which it may meet: a cell at a pole is one triangle, whose corner there takes the u
    of its middle, for no u holds at a pole."""
    corners, uv = wrapped_corners(nodes, repeat_u, heights)
    rows, around = nodes.shape[0] - 1, nodes.shape[1] - 1
    middle = (np.arange(around) + 0.5) / around * repeat_u
    pole = np.linalg.norm(corners[..., :2], axis=-1) == 0
    uv[..., 0] = np.where(pole, np.repeat(np.tile(middle, rows), 2)[:, None], uv[..., 0])
    split = pole.sum(axis=1) < 2  # the other triangle of a pole's cell has no area
    return corners[split], uv[split]


def turned(profile: np.ndarray, around: int, repeat_u: float, heights: np.ndarray) -> BaseMesh:
    """A curve turned around the z axis, its front outside where the curve runs upwards.

    Args:
        profile: (R + 1, 2) radius and height along the curve, m.
        around: cells around the axis.
        repeat_u: how often the texture repeats around it.
        heights: (R + 1,) v along the curve.
    """
    angle = 2 * math.pi * (np.arange(around + 1) % around) / around
    radius, height = profile[:, :1], profile[:, 1:]
    nodes = np.stack(np.broadcast_arrays(radius * np.cos(angle), radius * np.sin(angle), height), axis=-1)
    return from_corners(*turned_corners(nodes, repeat_u, heights))


def arc_lengths(profile: np.ndarray) -> np.ndarray:
    """Share of a curve's length that lies before each of its points, (R + 1,)."""
    steps = np.linalg.norm(np.diff(profile, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    shares: np.ndarray = along / along[-1]
    return shares


def tube(radius: float, length: float, around: int, along: int, repeat_u: float, repeat_v: float) -> BaseMesh:
    """An open cylinder around the z axis, centred at the origin, m."""
    share = np.arange(along + 1) / along
    profile = np.stack([np.full(along + 1, radius), (share - 0.5) * length], axis=-1)
    return turned(profile, around, repeat_u, share * repeat_v)


def globe(radius: float, around: int, repeat_u: float, repeat_v: float) -> BaseMesh:
    """A sphere by longitude (u eastwards) and latitude (v northwards), with half as many rows as cells around."""
    rows = max(around // 2, 2)
    share = np.arange(rows + 1) / rows
    across = radius * np.sin(math.pi * share)
    across[[0, -1]] = 0.0
    profile = np.stack([across, -radius * np.cos(math.pi * share)], axis=-1)
    return turned(profile, around, repeat_u, share * repeat_v)


def cube_sphere(radius: float, divisions: int, repeat_u: float, repeat_v: float) -> BaseMesh:
    """A sphere from a cube's six squares, each with the whole texture: nothing is pinched at poles.

    Equal angles, not equal lengths, cut the squares: cells at a corner stay within a factor of 1.5 of those in the
    middle.
    """
    tangent = np.tan((2 * np.arange(divisions + 1) - divisions) / divisions * (math.pi / 4))
    tangent = (tangent - tangent[::-1]) / 2  # odd to the last bit, so that neighbouring squares share their edge
    tangent[[0, -1]] = (-1.0, 1.0)
    x, y = np.meshgrid(tangent, tangent)
    one = np.ones_like(x)
    squares = [(one, x, y), (-one, -x, y), (-x, one, y), (x, -one, y), (-y, x, one), (y, x, -one)]
    uv = grid_uv(divisions, divisions, repeat_u, repeat_v)
    parts = []
    for square in squares:
        nodes = np.stack(square, axis=-1)
        # The sum of squares in one order for all squares of the cube, again for the last bit.
        length = np.sqrt(np.sort(nodes * nodes, axis=-1).sum(axis=-1, keepdims=True))
        parts.append(grid_corners(radius * nodes / length, uv))
    return from_corners(np.concatenate([corner for corner, _ in parts]), np.concatenate([at for _, at in parts]))


def planks(count: int, radius: float, width: float, tilt: float, along: int, repeat: float) -> BaseMesh:
    """Planks in a ring, each with one end over the next: seen from above, each hides the next and the last the first.

    Args:
        count: of planks. radius: of the circle that they touch, m. width: of each, m.
        tilt: angle by which they rise along the ring, rad. along: cells along each.
        repeat: how often the texture stands across a plank, and along it in the same proportion.
    """
    crossing = radius * math.tan(math.pi / count)
    length = 2 * crossing + 2 * width
    share = np.arange(along + 1) / along - 0.5
    across, ahead = np.meshgrid((np.arange(2) - 0.5) * width, share * length, indexing="ij")
    # The front is above: x outwards to the right of y ahead would look down, so columns run ahead and rows inwards.
    uv = grid_uv(1, along, repeat * length / width, repeat)
    parts = []
    for number in range(count):
        turn = 2 * math.pi * number / count
        out, on = np.array([math.cos(turn), math.sin(turn), 0.0]), np.array([-math.sin(turn), math.cos(turn), 0.0])
        rise = on * math.cos(tilt) + np.array([0.0, 0.0, math.sin(tilt)])
        nodes = radius * out - across[..., None] * out + ahead[..., None] * rise
        parts.append(from_corners(*grid_corners(nodes, uv)))
    return side_by_side(parts)
