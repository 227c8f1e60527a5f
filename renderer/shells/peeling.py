"""Depth peeling of a shell's cells: Everitt 2001; Dufort 2005, section 4.2."""

from __future__ import annotations

from typing import TYPE_CHECKING

import moderngl

from renderer.gl.context import GL
from renderer.gl.layers import check_drawable
from renderer.gl.source import Source
from renderer.gl.targets import run_fullscreen
from renderer.shells.cells import Cells
from renderer.shells.program import composed, variant_of
from renderer.shells.raster import CELL_DECLARATIONS, UNDER, Canvas, lit_source, placed_values, switched

if TYPE_CHECKING:
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

PEEL_DECLARATIONS = """uniform sampler2D peel_before;
uniform sampler2D raster_base;
uniform int layer_number;
"""

PEEL_BODY = """layout(location = 0) out vec2 layer;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float t = plane_distance(pixel_ray(gl_FragCoord.xy), cell_entry);
    // Where the layer before found nothing, nothing is left.
    vec2 last = layer_number > 0 ? texelFetch(peel_before, pixel, 0).xy : vec2(-1.0e30, 1.0);
    if (last.y < 0.5 || order_peeled(t, last.x, texelFetch(raster_base, pixel, 0).a)) discard;
    layer = vec2(t, number + 1.0);
}"""

SHADE_DECLARATIONS = "uniform sampler2D peel_layer;     // distance, m, and 4 cell + face + 1, or 0"

SHADE_BODY = """layout(location = 0) out vec4 gathered;
void main() {
    vec2 layer = texelFetch(peel_layer, ivec2(gl_FragCoord.xy), 0).xy;
    if (layer.y < 0.5) discard;
    Ray ray = pixel_ray(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    gather_cell(ray, cell_numbered(ray, max(layer.x, 0.0), int(layer.y - 0.5)), sum);
    gathered = buffer_of(sum);
}"""


class _Sheet:
    """One layer of a view."""

    def __init__(self, gl: GL, size: tuple[int, int]) -> None:
        check_drawable(gl, *size)
        self.texture = gl.ctx.texture(size, 2, dtype="f4")
        self.texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self._depth = gl.ctx.depth_renderbuffer(size)
        self.framebuffer = gl.ctx.framebuffer([self.texture], self._depth)

    def release(self) -> None:
        self.framebuffer.release()
        self._depth.release()
        self.texture.release()


def peel(frame: Frame, cells: Cells, canvas: Canvas, most: int) -> int:
    """Draw layer after layer of the arranged cells into a canvas, until a query of samples says that none is left.

    Returns:
        How many layers there were, at most `most`.
    """
    gl = frame.renderer.rasters.gl
    sheets = [_Sheet(gl, frame.size) for _ in range(2)]
    query = gl.ctx.query(samples=True)
    find, shade = peel_source(frame.state), lit_source(frame.state, SHADE_BODY, SHADE_DECLARATIONS)
    values = placed_values(frame)
    passes = 0
    try:
        for layer in range(most):
            sheet, before = sheets[layer % 2], sheets[(layer + 1) % 2]
            sheet.framebuffer.clear(0.0, 0.0, 0.0, 0.0, depth=1.0)
            sheet.framebuffer.use()
            read = {**frame.textures, "peel_before": before.texture, "raster_base": canvas.base}
            with switched(gl, moderngl.DEPTH_TEST | moderngl.CULL_FACE), query:
                cells.draw(find, read, {**values, "layer_number": layer})
            if query.samples == 0:
                break
            passes = layer + 1
            canvas.into_gathered.use()
            with switched(gl, moderngl.NOTHING, UNDER):
                run_fullscreen(gl, shade, {**frame.textures, "peel_layer": sheet.texture}, values)
    finally:
        for sheet in sheets:
            sheet.release()
    return passes


def peel_source(state: ShellsState) -> Source:
    """The stage that keeps what lies behind the layer before."""
    files = ("shells/order/depth_peeling.glsl",)
    return composed((), variant_of(state), files, PEEL_BODY, CELL_DECLARATIONS + "\n" + PEEL_DECLARATIONS)
