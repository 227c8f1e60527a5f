"""All cells of a shell on the GPU, drawn in an order that is given."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import moderngl
import numpy as np

from renderer.core.technique import Arrays
from renderer.gl.context import GL
from renderer.gl.meshes import Triangles
from renderer.gl.program import AnyTexture, bind_textures, set_uniforms
from renderer.gl.source import Source, stage
from renderer.shells.resident import Placed, faces_of
from renderer.shells.world_scale import BASE
from renderer.world.camera import Orthographic, pose

WAYS = np.array([[2, 3, 1], [0, 3, 2], [0, 1, 3], [2, 1, 0]])
"""Corners of the face opposite each corner k, counter-clockwise from outside; the last of them is (k + 1) % 4."""

VERTEX = """uniform mat4 view_projection;
uniform sampler2D shell_tets;
uniform vec2 texture_slide;"""


class Cells:
    """The tetrahedra's faces by `shaders/shells/cells.vert`, and those of the opaque surface under them.

    Args:
        gl: the context's objects.
        shell: arrays of the shell's bake. place: where it stands.
    """

    def __init__(self, gl: GL, shell: Arrays, place: Placed) -> None:
        self._gl = gl
        self.count = len(shell["tets"])
        corners = shell["positions"][shell["tets"]] - place.centre
        data = np.empty((self.count, 4, 4), np.float32)
        data[..., :3] = corners
        data[..., 3] = 4 * np.arange(self.count)[:, None] + (np.arange(4) + 3) % 4
        self._vertices = gl.ctx.buffer(data.tobytes())
        self._faces = faces_out(corners)
        self._indices: moderngl.Buffer | None = None
        self._drawn = 0
        tet, face = np.nonzero(shell["neighbour"] == BASE)
        self.base = Triangles(gl, *faces_of(shell, place.centre, tet, face))

    def arrange(self, order: np.ndarray, facing: np.ndarray) -> None:
        """Say which cells are drawn next, and in which order.

        Args:
            order: (N,) numbers of cells. facing: (T, 4) bool, faces that the camera sees.
        """
        indices = self._faces[order][facing[order]]
        self._drawn = indices.size
        if self._indices is not None:
            self._indices.release()
            self._indices = None
        if self._drawn:
            self._indices = self._gl.ctx.buffer(np.ascontiguousarray(indices).tobytes())

    def draw(self, fragment: Source, textures: Mapping[str, AnyTexture], values: Mapping[str, Any]) -> None:
        """Draw the arranged faces into the bound framebuffer, as the pipeline's switches are set."""
        if self._indices is None:
            return
        program = self._gl.programs.get(stage("shells/cells.vert", VERTEX), fragment)
        bind_textures(program, textures)
        set_uniforms(program, values)
        # A stage that only counts reads no number, and its compiler leaves it out.
        read = ("3f 1f", "position", "owner") if "owner" in program else ("3f 4x", "position")
        array = self._gl.ctx.vertex_array(program, [(self._vertices, *read)], self._indices)
        try:
            array.render(mode=moderngl.TRIANGLES)
        finally:
            array.release()

    def release(self) -> None:
        """Free them."""
        self._vertices.release()
        self.base.release()
        if self._indices is not None:
            self._indices.release()


def faces_out(corners: np.ndarray) -> np.ndarray:
    """Numbers (T, 4, 3) uint32 of the corners of each cell's faces, counter-clockwise seen from outside of it.

    Args:
        corners: (T, 4, 3) m.
    """
    edges = corners[:, 1:] - corners[:, :1]
    mirrored = np.linalg.det(edges) < 0
    ways = np.broadcast_to(WAYS, (len(corners), 4, 3)).copy()
    ways[mirrored] = ways[mirrored][:, :, [1, 0, 2]]
    return (ways + 4 * np.arange(len(corners))[:, None, None]).astype(np.uint32)


def facing(shell: Arrays, camera: Any) -> np.ndarray:
    """Which faces (T, 4) bool of the cells turn to the camera."""
    at, planes = pose(camera), shell["planes"]
    if isinstance(camera, Orthographic):
        return np.asarray(planes[..., :3] @ at.forward < 0)
    return np.asarray(planes[..., :3] @ at.eye + planes[..., 3] > 0)
