"""Triangles on the GPU, and how they are drawn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import moderngl
import numpy as np

from renderer.gl.context import GL
from renderer.gl.program import AnyTexture, bind_textures, set_uniforms
from renderer.gl.source import Source, stage

VERTEX_BYTES = 16
"""A place and the triangle's number, in single precision."""


class Triangles:
    """Triangles with a number each, drawn by `shaders/stages/mesh.vert`.

    Args:
        gl: the context's objects.
        corners: (F, 3, 3) places [m].
        owner: (F,) numbers below 2^24.
    """

    def __init__(self, gl: GL, corners: np.ndarray, owner: np.ndarray) -> None:
        self._gl = gl
        self.count = len(corners)
        self._buffer = gl.ctx.buffer(_packed(corners, owner)) if len(corners) else None

    def write(self, first: int, corners: np.ndarray, owner: np.ndarray) -> None:
        """Put other triangles in the places of those from number `first` on."""
        if self._buffer is not None:
            self._buffer.write(_packed(corners, owner), offset=first * VERTEX_BYTES * 3)

    def read(self) -> bytes:
        """What the GPU holds of them."""
        return self._buffer.read() if self._buffer is not None else b""

    def draw(self, fragment: Source, textures: Mapping[str, AnyTexture], values: Mapping[str, Any]) -> None:
        """Draw them into the bound framebuffer, as the pipeline's switches are set.

        Args:
            fragment: reads `flat in float number`.
            textures, values: of its samplers and uniforms, and `view_projection`.
        """
        if self._buffer is None:
            return
        program = self._gl.programs.get(stage("stages/mesh.vert"), fragment)
        bind_textures(program, textures)
        set_uniforms(program, values)
        array = self._gl.ctx.vertex_array(program, [(self._buffer, "3f 1f", "position", "owner")])
        try:
            array.render(mode=moderngl.TRIANGLES)
        finally:
            array.release()

    def release(self) -> None:
        """Free them."""
        if self._buffer is not None:
            self._buffer.release()
            self._buffer = None


def _packed(corners: np.ndarray, owner: np.ndarray) -> bytes:
    data = np.empty((len(corners), 3, 4), np.float32)
    data[..., :3] = corners
    data[..., 3] = owner[:, None]
    return data.tobytes()
