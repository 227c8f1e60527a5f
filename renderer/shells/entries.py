"""Where rays come into the shell: the faces of its boundary that face them, peeled layer by layer.

Everitt 2001, "Interactive order-independent transparency", of the boundary alone: few layers, whatever lies between.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Hashable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import moderngl

from renderer.gl.context import GL
from renderer.gl.layers import Kind, check_drawable
from renderer.gl.meshes import Triangles
from renderer.gl.program import AnyTexture
from renderer.gl.source import Source
from renderer.gl.targets import run_covered, run_fullscreen
from renderer.shells.program import entry_sources
from renderer.shells.world_scale import MOST_LAYERS

VIEWS_KEPT = 6
"""Views whose entries are kept, so that a moved sun finds the camera's again: of two pictures side by side, each with
the rays of its first sample and of later ones, and of their suns."""

PIXELS_KEPT = 2**22
"""Of all of them together; what one picture needs is kept whatever its size."""

CLIP_DISTANCE = 0x3000
"""OpenGL's GL_CLIP_DISTANCE0."""

CLIPPING = ("clip_first", "clip_second")
"""Uniforms of the planes in `shaders/stages/mesh.vert`."""

NO_PLANE = (0.0, 0.0, 0.0, 0.0)
"""Nothing is on its negative side."""

OF_A_PICTURE = 3
"""Views of one picture at most: its sun's, and those of its first and of later samples."""


@dataclass(frozen=True)
class View:
    """From where rays come.

    Attributes:
        key: of camera, sample and shell: equal ones have the same entries. size: (width, height) in pixels.
        triangles: of the shell's boundary. projection: (4, 4) from metres round the shell's middle to clip space.
        planes: (4,) each, on whose negative side nothing is drawn; two or none.
    """

    key: Hashable
    size: tuple[int, int]
    triangles: Triangles
    projection: Any
    planes: tuple[Any, ...] = ()


class _Sheet:
    """The first layer of one view, or every second of the others, one above the other in one texture.

    A layer reads the one before, which may therefore not lie in the texture it is drawn into.
    """

    def __init__(self, gl: GL, width: int, height: int) -> None:
        check_drawable(gl, width, height)
        self.texture = _texture(gl, (width, height), (2, "f4"))
        self.depth = gl.ctx.depth_renderbuffer((width, height))
        self.framebuffer = gl.ctx.framebuffer([self.texture], self.depth)

    def release(self) -> None:
        self.framebuffer.release()
        self.depth.release()
        self.texture.release()


class Layers:
    """Layers of entries of one view, and what was drawn where rays come in at all."""

    def __init__(self, gl: GL, size: tuple[int, int], rows: int) -> None:
        self._gl = gl
        self.size = size
        self.rows = rows
        self.count = 0
        self.first = _Sheet(gl, *size)
        self.sheets = [_Sheet(gl, size[0], size[1] * rows) for _ in range(2)]
        self._shown: dict[tuple[Kind, ...], Hashable] = {}
        self._drawn: dict[tuple[Kind, ...], tuple[list[moderngl.Texture], moderngl.Framebuffer]] = {}

    def begin(self) -> None:
        """Forget what was there: another view is peeled."""
        self.count = 0
        self._shown = {}

    @property
    def textures(self) -> dict[str, AnyTexture]:
        """`entry_first`, `entry_odd` and `entry_even`."""
        odd, even = (sheet.texture for sheet in self.sheets)
        return {"entry_first": self.first.texture, "entry_odd": odd, "entry_even": even}

    @property
    def values(self) -> dict[str, Any]:
        """`entry_layers`, how many there are, and `entry_height`."""
        return {"entry_layers": self.count, "entry_height": self.size[1]}

    def holds(self, kinds: tuple[Kind, ...], shows: Hashable) -> bool:
        """Whether textures of these kinds show that already."""
        return shows is not None and self._shown.get(kinds) == shows

    def draw(
        self,
        kinds: tuple[Kind, ...],
        nothing: float | None,
        fragment: Source,
        textures: Mapping[str, AnyTexture],
        values: Mapping[str, Any],
        shows: Hashable = None,
        everywhere: bool = False,
    ) -> list[moderngl.Texture]:
        """Run a stage where rays come in, unless what it shows is still there.

        Args:
            kinds: components and type of each texture. nothing: what they hold where no ray comes in; None
                where nobody asks.
            fragment, textures, values: of the stage, beside the entries.
            shows: equal where the stage would draw the same again; None where it never would.
            everywhere: whether it runs where no ray comes in, too: for a camera within the shell.

        Returns:
            The textures; they hold until the next drawing of the same kinds.
        """
        if kinds not in self._drawn:
            made = [_texture(self._gl, self.size, kind) for kind in kinds]
            self._drawn[kinds] = made, self._gl.ctx.framebuffer(made, self.first.depth)
        made, framebuffer = self._drawn[kinds]
        if self.holds(kinds, shows):
            return made
        self._shown[kinds] = shows
        framebuffer.depth_mask = False
        framebuffer.use()
        if nothing is not None:
            framebuffer.clear(nothing, nothing, nothing, nothing)
        run = run_fullscreen if everywhere else run_covered
        run(self._gl, fragment, {**textures, **self.textures}, {**values, **self.values})
        return made

    def release(self) -> None:
        """Free everything."""
        for made, framebuffer in self._drawn.values():
            framebuffer.release()
            for texture in made:
                texture.release()
        self._drawn = {}
        for sheet in (self.first, *self.sheets):
            sheet.release()

    def place(self, layer: int) -> tuple[_Sheet, int]:
        """The sheet of a layer, and the row where it begins."""
        return (self.sheets[(layer - 1) % 2], (layer - 1) // 2 * self.size[1]) if layer else (self.first, 0)


class Entries:
    """Layers of entries by what they show, the longest unasked drawn over first."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        self._held: OrderedDict[Hashable, Layers] = OrderedDict()
        self._rows = 1

    def find(self, view: View) -> Layers:
        """The layers of a view."""
        whole = (view.key, view.size)
        if whole not in self._held:
            self._held[whole] = self._peeled(view)
        self._held.move_to_end(whole)
        return self._held[whole]

    def release(self) -> None:
        """Free everything."""
        while self._held:
            self._held.popitem()[1].release()

    def _peeled(self, view: View) -> Layers:
        while True:
            layers = self._room(view.size)
            try:
                whole = self._peel(layers, view)
            except BaseException:
                layers.release()
                raise
            if whole or 2 * self._rows >= MOST_LAYERS:
                return layers
            layers.release()
            self._rows *= 2

    def _room(self, size: tuple[int, int]) -> Layers:
        """Layers of a size: old ones, when enough are kept."""
        while len(self._held) >= (VIEWS_KEPT if self._pixels() + math.prod(size) <= PIXELS_KEPT else OF_A_PICTURE + 1):
            spare = self._held.popitem(last=False)[1]
            if (spare.size, spare.rows) == (size, self._rows):
                return spare
            spare.release()
        return Layers(self._gl, size, self._rows)

    def _pixels(self) -> int:
        return sum(math.prod(layers.size) for layers in self._held.values())

    def _peel(self, layers: Layers, view: View) -> bool:
        """Whether all layers found room."""
        ctx, size, fragments = self._gl.ctx, view.size, entry_sources()
        ctx.enable_only(moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        query = ctx.query(samples=True)
        planes = view.planes or (NO_PLANE,) * len(CLIPPING)
        where = {"view_projection": view.projection, **dict(zip(CLIPPING, planes, strict=True))}
        layers.begin()
        for layer in range(1 + 2 * layers.rows):
            sheet, row = layers.place(layer)
            sheet.framebuffer.use()
            sheet.framebuffer.viewport = (0, row, *size)
            sheet.framebuffer.clear(-1.0, -1.0, 0.0, 0.0, viewport=(0, row, *size))
            before, before_row = layers.place(layer - 1) if layer else (None, 0)
            rows = {"layer_row": row, "before_row": before_row} if layer else {}
            textures = {"entry_before": before.texture} if before else {}
            with query, _clipped(ctx):
                view.triangles.draw(fragments[min(layer, 1)], textures, where | rows)
            if query.samples == 0:
                break
            layers.count = layer + 1
        ctx.enable_only(moderngl.NOTHING)
        return layers.count < 1 + 2 * layers.rows


@contextmanager
def _clipped(ctx: moderngl.Context) -> Iterator[None]:
    """Cut what is drawn at the planes that its vertices are told.

    All of them are told always: llvmpipe clips by what a program writes, enabled or not.
    """
    for number in range(len(CLIPPING)):
        ctx.enable_direct(CLIP_DISTANCE + number)
    try:
        yield
    finally:
        for number in range(len(CLIPPING)):
            ctx.disable_direct(CLIP_DISTANCE + number)


def _texture(gl: GL, size: tuple[int, int], kind: Kind) -> moderngl.Texture:
    texture = gl.ctx.texture(size, kind[0], dtype=kind[1])
    texture.filter = moderngl.NEAREST, moderngl.NEAREST
    return texture
