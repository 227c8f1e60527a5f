"""Where rays come into the shell: the faces of its boundary that face them, peeled layer by layer.

Everitt 2001, "Interactive order-independent transparency", of the boundary alone: few layers, whatever lies between.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Mapping
from typing import Any

import moderngl

from renderer.gl.context import GL
from renderer.gl.layers import check_drawable
from renderer.gl.meshes import Triangles
from renderer.gl.program import AnyTexture
from renderer.gl.source import Source
from renderer.shells.world_scale import MOST_LAYERS

BYTES_KEPT = 96 << 20
"""Of all layers kept, so that a moved sun finds the camera's again."""


class _Sheet:
    """Every second layer of one view, one above the other in one texture.

    A layer reads the one before, which may therefore not lie in the texture it is drawn into.
    """

    def __init__(self, gl: GL, width: int, height: int) -> None:
        check_drawable(gl, width, height)
        self.texture = gl.ctx.texture((width, height), 2, dtype="f4")
        self.texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self._depth = gl.ctx.depth_renderbuffer((width, height))
        self.framebuffer = gl.ctx.framebuffer([self.texture], self._depth)

    def release(self) -> None:
        self.framebuffer.release()
        self._depth.release()
        self.texture.release()


class _Layers:
    """Layers of one view."""

    def __init__(self, gl: GL, size: tuple[int, int], rows: int) -> None:
        self.sheets = [_Sheet(gl, size[0], size[1] * rows) for _ in range(2)]
        self.rows = rows
        self.count = 0
        self.bytes = 2 * size[0] * size[1] * rows * 12

    def release(self) -> None:
        for sheet in self.sheets:
            sheet.release()


class Entries:
    """Layers of entries by what they show, the longest unasked given back first."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        self._held: OrderedDict[Hashable, _Layers] = OrderedDict()
        self._rows = 1

    def find(
        self,
        key: Hashable,
        size: tuple[int, int],
        triangles: Triangles,
        fragment: Source,
        textures: Mapping[str, AnyTexture],
        values: Mapping[str, Any],
    ) -> tuple[dict[str, AnyTexture], dict[str, Any]]:
        """The layers of a view.

        Args:
            key: of camera, sample and shell.
            size: (width, height) in pixels.
            triangles: of the shell's boundary.
            fragment: writes distance and tetrahedron, and leaves out what is not behind the layer before.
            textures, values: what it reads, `view_projection` among them.

        Returns:
            `entry_even` and `entry_odd`, and `entry_layers`, how many there are, with `entry_height`.
        """
        whole = (key, size)
        if whole not in self._held:
            self._held[whole] = self._peeled(size, triangles, fragment, textures, values)
            while len(self._held) > 1 and sum(held.bytes for held in self._held.values()) > BYTES_KEPT:
                self._held.popitem(last=False)[1].release()
        self._held.move_to_end(whole)
        layers = self._held[whole]
        even, odd = (sheet.texture for sheet in layers.sheets)
        return {"entry_even": even, "entry_odd": odd}, {"entry_layers": layers.count, "entry_height": size[1]}

    def _peeled(
        self,
        size: tuple[int, int],
        triangles: Triangles,
        fragment: Source,
        textures: Mapping[str, AnyTexture],
        values: Mapping[str, Any],
    ) -> _Layers:
        while True:
            layers = _Layers(self._gl, size, self._rows)
            if self._peel(layers, size, triangles, fragment, textures, values) or 2 * self._rows >= MOST_LAYERS:
                return layers
            layers.release()
            self._rows *= 2

    def _peel(
        self,
        layers: _Layers,
        size: tuple[int, int],
        triangles: Triangles,
        fragment: Source,
        textures: Mapping[str, AnyTexture],
        values: Mapping[str, Any],
    ) -> bool:
        """Whether all layers found room."""
        ctx = self._gl.ctx
        ctx.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        query = ctx.query(samples=True)
        for sheet in layers.sheets:
            sheet.framebuffer.viewport = (0, 0, size[0], size[1] * layers.rows)
            sheet.framebuffer.clear(-1.0, -1.0, 0.0, 0.0)
        for layer in range(2 * layers.rows):
            sheet, before = layers.sheets[layer % 2], layers.sheets[(layer + 1) % 2]
            sheet.framebuffer.use()
            sheet.framebuffer.viewport = (0, layer // 2 * size[1], *size)
            here = {"layer_number": layer, "layer_row": layer // 2 * size[1], "before_row": (layer - 1) // 2 * size[1]}
            with query:
                triangles.draw(fragment, {**textures, "entry_before": before.texture}, {**values, **here})
            if query.samples == 0:
                break
            layers.count = layer + 1
        else:
            ctx.enable_only(moderngl.NOTHING)
            return False
        ctx.enable_only(moderngl.NOTHING)
        return True

    def release(self) -> None:
        """Free everything."""
        while self._held:
            self._held.popitem()[1].release()
