"""Which blocks of a picture a cloud may show in, and between which distances from the eye.

The points are counted into small cubes once. For each view the cubes are carried to the picture, which finds the blocks
without any: their pixels are never asked for a point, and where others begin to look for one, nothing lies before.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import moderngl
import numpy as np
from numba import njit
from numpy.typing import NDArray

from renderer.gl.context import GL
from renderer.gl.program import AnyTexture, bind_textures, set_uniforms
from renderer.gl.source import Source, stage
from renderer.world.camera import Orthographic, pose

TILE = 8
"""Side of a block, px: `TILE` in the shaders."""

CELLS = 64
"""Cubes along the box's longest side."""

MARGIN = 1.0
"""Pixels by which a sample may lie beside its pixel's middle, and rounding."""

FAR = 1e30
"""Beyond everything, m."""

Floats = NDArray[np.float32]


def occupied(positions: np.ndarray, box: np.ndarray) -> tuple[np.ndarray, float]:
    """The cubes that hold points: their middles (C, 3) [m] from the middle of the box, and their side [m].

    Args:
        positions: (N, 3) [m]. box: (2, 3) [m].
    """
    extent = np.asarray(box[1] - box[0], np.float64)
    side = float(extent.max()) / CELLS
    counts = np.maximum(np.ceil(extent / side - 1e-9).astype(int), 1)
    place = np.clip(((positions - box[0]) / side).astype(np.int32), 0, counts - 1)
    held = np.zeros(counts, bool)
    held[place[:, 0], place[:, 1], place[:, 2]] = True
    return (np.argwhere(held) + 0.5) * side - extent / 2, side


@njit(cache=True, nogil=True)
def _bounds(cells, half, axes, eye, parallel, scale, width, height, near, far):
    """Fill `near` and `far` (rows, columns), row 0 at the bottom; false where a cube reaches behind the eye."""
    rows, columns = near.shape
    spread = np.abs(axes).sum(axis=1) * half
    ball = half * np.sqrt(3.0)
    for n in range(len(cells)):
        away = cells[n] - eye
        x = axes[0, 0] * away[0] + axes[0, 1] * away[1] + axes[0, 2] * away[2]
        y = axes[1, 0] * away[0] + axes[1, 1] * away[1] + axes[1, 2] * away[2]
        z = axes[2, 0] * away[0] + axes[2, 1] * away[1] + axes[2, 2] * away[2]
        if parallel:
            nearer = farther = 1.0
            begin, end = z - spread[2], z + spread[2]
        else:
            nearer, farther = z - spread[2], z + spread[2]
            if nearer <= 1e-3 * half:
                return False
            distance = np.sqrt(x * x + y * y + z * z)
            begin, end = distance - ball, distance + ball
        low, high = x - spread[0], x + spread[0]
        left = 0.5 * width + scale * (low / (nearer if low < 0 else farther)) - MARGIN
        right = 0.5 * width + scale * (high / (farther if high < 0 else nearer)) + MARGIN
        low, high = y - spread[1], y + spread[1]
        bottom = 0.5 * height + scale * (low / (nearer if low < 0 else farther)) - MARGIN
        top = 0.5 * height + scale * (high / (farther if high < 0 else nearer)) + MARGIN
        if right < 0 or left >= width or top < 0 or bottom >= height:
            continue
        for row in range(int(max(bottom, 0.0)) // TILE, min(int(top) // TILE, rows - 1) + 1):
            for column in range(int(max(left, 0.0)) // TILE, min(int(right) // TILE, columns - 1) + 1):
                near[row, column] = min(near[row, column], begin)
                far[row, column] = max(far[row, column], end)
    return True


def bounds(
    cells: np.ndarray, side: float, reach: float, camera: Any, middle: np.ndarray, size: tuple[int, int]
) -> Floats:
    """(rows, columns, 2) nearest and farthest distance [m] along the rays of each block, row 0 at the bottom of the
    picture: from the eye, or from its plane in a parallel view. `FAR` and 0 where there is nothing.

    Args:
        cells, side: of `occupied`. reach: how far beyond its point a texel may show it [m].
        camera: of the state. middle: of the box [m]. size: (width, height) of the picture in pixels.
    """
    width, height = size
    shape = -(-height // TILE), -(-width // TILE)
    near, far = np.full(shape, FAR, np.float32), np.zeros(shape, np.float32)
    at, parallel = pose(camera), isinstance(camera, Orthographic)
    scale = width / camera.width if parallel else height / (2 * np.tan(np.radians(camera.field_of_view) / 2))
    axes = np.stack([at.right, at.up, at.forward])
    whole = _bounds(cells, side / 2 + reach, axes, at.eye - middle, parallel, scale, width, height, near, far)
    if not whole:
        near[:], far[:] = -FAR, FAR
    return np.stack([near, far], axis=-1)


def runs(shown: np.ndarray) -> np.ndarray:
    """Rectangles (R, 4) of whole blocks in their rows: left, bottom, right and top, in blocks.

    Args:
        shown: (rows, columns) bool.
    """
    edges = np.diff(np.pad(shown, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    row, left = np.nonzero(edges > 0)
    right = np.nonzero(edges < 0)[1]
    return np.stack([left, row, right, row + 1], axis=-1)


class Tiles:
    """The blocks of a picture on the GPU.

    Args:
        gl: the context's objects. size: (width, height) of the picture in pixels.
    """

    def __init__(self, gl: GL, size: tuple[int, int]) -> None:
        self._gl, self._size = gl, size
        shape = -(-size[0] // TILE), -(-size[1] // TILE)
        self.bounds = gl.ctx.texture(shape, 2, dtype="f4")
        self.bounds.filter = moderngl.NEAREST, moderngl.NEAREST
        self._corners: moderngl.Buffer | None = None

    def hold(self, found: Floats) -> None:
        """Have the blocks of `bounds`."""
        self.bounds.write(np.ascontiguousarray(found).tobytes(), alignment=1)
        boxes = runs(found[..., 0] < found[..., 1]).astype(np.float32) * TILE
        corners = boxes[:, [0, 1, 2, 1, 2, 3, 0, 1, 2, 3, 0, 3]].reshape(-1, 2) * (2 / np.array(self._size)) - 1
        if self._corners is not None:
            self._corners.release()
        self._corners = self._gl.ctx.buffer(corners.astype(np.float32).tobytes()) if len(corners) else None

    def draw(self, source: Source, textures: Mapping[str, AnyTexture], values: Mapping[str, Any]) -> None:
        """Run a fragment stage once per pixel of the blocks that may show something, and keep the depth it gives."""
        if self._corners is None:
            return
        program = self._gl.programs.get(stage("stages/placed.vert"), source)
        set_uniforms(program, values)
        bind_textures(program, {**textures, "tile_bounds": self.bounds})
        self._gl.ctx.enable(moderngl.DEPTH_TEST)
        self._gl.ctx.depth_func = "1"  # always
        array = self._gl.ctx.vertex_array(program, [(self._corners, "2f", "place")])
        try:
            array.render(mode=moderngl.TRIANGLES)
            self._gl.programs.wait()
        finally:
            array.release()
            self._gl.ctx.disable(moderngl.DEPTH_TEST)
            self._gl.ctx.depth_func = "<"

    def release(self) -> None:
        """Free everything."""
        self.bounds.release()
        if self._corners is not None:
            self._corners.release()
