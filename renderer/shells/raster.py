"""Cells drawn into a picture: what all orders but the walk share.

A cell's faces that turn to the camera are drawn; a fragment finds where its ray leaves the cell and gathers what lies
between (Dufort 2005, section 5.1.1). The opaque surface is drawn first: its depth hides the cells behind it, and its
light is laid behind them at the end.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from renderer.gl.context import GL
from renderer.gl.layers import check_drawable
from renderer.gl.program import AnyTexture
from renderer.gl.source import Source
from renderer.shells.cells import Cells, facing
from renderer.shells.program import LIT_SLOTS, chosen, composed, variant_of
from renderer.shells.thing_mesh import things_source
from renderer.shells.world_scale import BASE

if TYPE_CHECKING:
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

CANVASES_KEPT, CELLS_KEPT = 2, 4

CELL_DECLARATIONS = """flat in float number;             // 4 cell + face
flat in vec4 cell_entry;          // the face's plane, and the cell's other three
flat in vec4 cell_a;
flat in vec4 cell_b;
flat in vec4 cell_c;
flat in vec4 cell_u;              // rows of the map to texture space
flat in vec4 cell_v;
flat in vec4 cell_w;"""

GATHER_BODY = """layout(location = 0) out vec4 gathered;
void main() {
    Ray ray = pixel_ray(gl_FragCoord.xy);
    float near = max(plane_distance(ray, cell_entry), 0.0);
    tet_here = int(number + 0.5) / 4;
    vec4 sum = vec4(0.0);
    gather_cell(ray, cell_segment(ray, near, cell_a, cell_b, cell_c, cell_u, cell_v, cell_w), sum);
    gathered = buffer_of(order_gathered(sum));
}"""

BASE_BODY = """flat in float number;
layout(location = 0) out vec4 base;
void main() {
    Ray ray = pixel_ray(gl_FragCoord.xy);
    int which = int(number + 0.5);
    float t = plane_distance(ray, tet_texel(which / 4, which % 4));
    base = vec4(base_radiance(ray, which / 4, which % 4, t), t);
}"""

COMPOSE_DECLARATIONS = """uniform sampler2D raster_gathered; // premultiplied, front to back
uniform sampler2D raster_base;     // light and distance (m) of the opaque surface, or 0"""

COMPOSE_BODY = """layout(location = 0) out vec4 radiance;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = texelFetch(raster_gathered, pixel, 0), base = texelFetch(raster_base, pixel, 0);
    sum.rgb *= buffer_white;
    if (base.a > 0.0) sum += (1.0 - sum.a) * vec4(base.rgb, 1.0);
    radiance = before_sky(sum.rgb, sum.a, pixel_ray(gl_FragCoord.xy).direction);
}"""


class Canvas:
    """What cells are drawn into.

    Attributes:
        gathered: the picture's light and opacity, in the type that the slot `accumulation` names.
        base: light of the opaque surface, with its distance [m], or 0. depth: that of the surface.
    """

    def __init__(self, gl: GL, size: tuple[int, int], dtype: str) -> None:
        check_drawable(gl, *size)
        self.gathered = gl.ctx.texture(size, 4, dtype=dtype)
        self.base = gl.ctx.texture(size, 4, dtype="f4")
        for texture in (self.gathered, self.base):
            texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self.depth = gl.ctx.depth_renderbuffer(size)
        self.into_gathered = gl.ctx.framebuffer([self.gathered], self.depth)
        self.into_base = gl.ctx.framebuffer([self.base], self.depth)

    def release(self) -> None:
        """Free it."""
        for held in (self.into_gathered, self.into_base, self.gathered, self.base, self.depth):
            held.release()


class Rasters:
    """Cells of shells and canvases, the longest unasked given back first."""

    def __init__(self, gl: GL) -> None:
        self.gl = gl
        self._cells: OrderedDict[Hashable, Cells] = OrderedDict()
        self._canvases: OrderedDict[Hashable, Canvas] = OrderedDict()
        self.said: dict[str, Any] = {}
        """What the last picture's order counted."""
        self.kept: dict[str, Any] = {}
        """What an order found that may serve the next picture, by its kind."""

    def cells(self, frame: Frame) -> Cells:
        """Those of the frame's shell."""
        key = frame.shell_key
        if key not in self._cells:
            self._cells[key] = Cells(self.gl, frame.arrays["shell"], frame.place)
            while len(self._cells) > CELLS_KEPT:
                self._cells.popitem(last=False)[1].release()
        self._cells.move_to_end(key)
        return self._cells[key]

    def canvas(self, frame: Frame) -> Canvas:
        """A cleared canvas of the frame's size, with the opaque surface drawn."""
        key = (frame.size, frame.state.accumulation.dtype)
        if key not in self._canvases:
            self._canvases[key] = Canvas(self.gl, *key)
            while len(self._canvases) > CANVASES_KEPT:
                self._canvases.popitem(last=False)[1].release()
        self._canvases.move_to_end(key)
        canvas = self._canvases[key]
        canvas.into_base.clear(0.0, 0.0, 0.0, 0.0)
        canvas.into_gathered.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)
        if frame.state.base.opaque:
            canvas.into_base.use()
            with switched(self.gl, moderngl.DEPTH_TEST):
                self.cells(frame).base.draw(base_source(frame.state), frame.textures, placed_values(frame))
        if frame.things is not None:
            canvas.into_base.use()
            with switched(self.gl, moderngl.DEPTH_TEST):
                frame.things.draw(things_source(frame.state), frame.textures, placed_values(frame))
            frame.textures["thing_seen"] = canvas.base
        return canvas

    def release(self) -> None:
        """Free everything."""
        while self._cells:
            self._cells.popitem()[1].release()
        while self._canvases:
            self._canvases.popitem()[1].release()


@contextmanager
def switched(gl: GL, switches: int, blend: tuple[int, int] | None = None) -> Iterator[None]:
    """Draw with switches of the pipeline on, and blended by two factors where they are given."""
    ctx = gl.ctx
    ctx.enable_only(switches | (moderngl.BLEND if blend else moderngl.NOTHING))
    if blend:
        ctx.blend_func = blend
    try:
        yield
    finally:
        ctx.enable_only(moderngl.NOTHING)
        ctx.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA


UNDER = (moderngl.ONE_MINUS_DST_ALPHA, moderngl.ONE)
"""Factors of front-to-back blending of premultiplied colour (erratum 002-3)."""


def seen_faces(frame: Frame) -> np.ndarray:
    """Faces (T, 4) bool of the cells that turn to the camera, without those that an opaque surface covers."""
    shell = frame.arrays["shell"]
    near = facing(shell, frame.state.camera)
    return near & (shell["neighbour"] != BASE) if frame.state.base.opaque else near


def placed_values(frame: Frame) -> dict[str, Any]:
    """The frame's uniforms with the matrix by which its triangles are drawn."""
    return {**frame.values, "view_projection": frame.matrix()}


def gather_source(state: ShellsState) -> Source:
    """The fragment stage that gathers what lies in a cell; the order's `order_gathered` says what is drawn of it."""
    return lit_source(state, GATHER_BODY, CELL_DECLARATIONS)


def base_source(state: ShellsState) -> Source:
    """The fragment stage that lights the opaque surface."""
    techniques = chosen(state, ("filter", "shadow", "light"))
    return composed(techniques, variant_of(state), ("shells/base.glsl", "shells/base_picture.glsl"), BASE_BODY)


def lit_source(state: ShellsState, body: str, more: str = "") -> Source:
    """A stage with all techniques of the state."""
    return composed(chosen(state, LIT_SLOTS), variant_of(state), ("shells/cell.glsl",), body, more)


def composing(frame: Frame, canvas: Canvas) -> tuple[Source, dict[str, AnyTexture], dict[str, Any]]:
    """The stage that lays a canvas before the background, with its textures and uniforms."""
    source = composed((), variant_of(frame.state), (), COMPOSE_BODY, COMPOSE_DECLARATIONS)
    textures = {**frame.textures, "raster_gathered": canvas.gathered, "raster_base": canvas.base}
    return source, textures, frame.values
