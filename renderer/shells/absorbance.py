"""Cells drawn in any order by moments of their absorbance: Münstermann, Krumpen, Klein & Peters 2018."""

from __future__ import annotations

from typing import TYPE_CHECKING

import moderngl
import numpy as np

from renderer.gl.source import Source
from renderer.gl.targets import run_fullscreen
from renderer.shells.cells import Cells
from renderer.shells.frame import reach
from renderer.shells.raster import CELL_DECLARATIONS, Canvas, lit_source, placed_values, seen_faces, switched

if TYPE_CHECKING:
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

DECLARATIONS = """uniform vec2 moment_reach;        // m along the rays, which depths -1 and 1 stand for
uniform sampler2D moment_low;     // b_0 and the sums of absorbance z, z^2, z^3
uniform sampler2D moment_high;    // of z^4
uniform sampler2D moment_light;   // light and opacity, as far as they are let through
"""

GATHERED = """    Ray ray = pixel_ray(gl_FragCoord.xy);
    float near = max(plane_distance(ray, cell_entry), 0.0);
    vec4 sum = vec4(0.0);
    tet_here = int(number + 0.5) / 4;
    Segment segment = cell_segment(ray, near, cell_a, cell_b, cell_c, cell_u, cell_v, cell_w);
    gather_cell(ray, segment, sum);
    float z = (segment.near + segment.far - moment_reach.x - moment_reach.y) / (moment_reach.y - moment_reach.x);
"""

SUM_BODY = f"""layout(location = 0) out vec4 low;
layout(location = 1) out vec4 high;
void main() {{
{GATHERED}
    float absorbance = -log(max(1.0 - sum.a, 1.0e-4));
    low = absorbance * vec4(1.0, z, z * z, z * z * z);
    high = absorbance * vec4(z * z * z * z);
}}"""

LIGHT_BODY = f"""layout(location = 0) out vec4 light;
void main() {{
{GATHERED}
    vec4 low = texelFetch(moment_low, ivec2(gl_FragCoord.xy), 0);
    vec4 sums = vec4(low.yzw, texelFetch(moment_high, ivec2(gl_FragCoord.xy), 0).x);
    light = sum * order_transmittance(low.x, sums, z);
}}"""

WHOLE_BODY = """layout(location = 0) out vec4 gathered;
void main() {
    vec4 light = texelFetch(moment_light, ivec2(gl_FragCoord.xy), 0);
    float opacity = 1.0 - exp(-texelFetch(moment_low, ivec2(gl_FragCoord.xy), 0).x);
    gathered = buffer_of(vec4(light.rgb / max(light.a, 1.0e-7) * opacity, opacity));
}"""


def draw_by_moments(frame: Frame, cells: Cells, canvas: Canvas, order: np.ndarray) -> None:
    """Draw all cells twice: their absorbance's moments, and their light by what these let through.

    Args:
        order: (T,) cells, in any order.
    """
    gl, (width, height) = frame.renderer.rasters.gl, frame.size
    near, far = reach(frame.state.camera, frame.place)
    values = {**placed_values(frame), "moment_reach": (near, far)}
    # Not cleared but made empty: clearing would take the surface's depth along.
    made = [gl.ctx.texture(frame.size, 4, bytes(16 * width * height), dtype="f4") for _ in range(3)]
    sums, light = gl.ctx.framebuffer(made[:2], canvas.depth), gl.ctx.framebuffer(made[2:], canvas.depth)
    sums.depth_mask = light.depth_mask = False
    names = ("moment_low", "moment_high", "moment_light")
    cells.arrange(order, seen_faces(frame))
    try:
        with switched(gl, moderngl.DEPTH_TEST | moderngl.CULL_FACE, (moderngl.ONE, moderngl.ONE)):
            sums.use()
            cells.draw(moment_source(frame.state, SUM_BODY), frame.textures, values)
            light.use()
            textures = {**frame.textures, **dict(zip(names[:2], made[:2], strict=True))}
            cells.draw(moment_source(frame.state, LIGHT_BODY), textures, values)
        canvas.into_gathered.use()
        textures = {**frame.textures, **dict(zip(names, made, strict=True))}
        run_fullscreen(gl, lit_source(frame.state, WHOLE_BODY, DECLARATIONS), textures, values)
        gl.finish()
    finally:
        sums.release()
        light.release()
        for texture in made:
            texture.release()


def moment_source(state: ShellsState, body: str) -> Source:
    """A stage that gathers along a cell."""
    return lit_source(state, body, CELL_DECLARATIONS + "\n" + DECLARATIONS)
