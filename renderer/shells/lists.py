"""What lies in each pixel as a list on the GPU: counted, given room, filled, sorted in the shader.

Yang, Hensley, Gruen & Thibieroz 2010, "Real-time concurrent linked list construction on the GPU", but with the lengths
counted before: each list is then one piece of memory, all of it bounded beforehand, and is sorted where it lies.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import moderngl
import numpy as np

from renderer.core.errors import LimitError
from renderer.gl.source import Source
from renderer.gl.targets import run_fullscreen
from renderer.shells.cells import Cells
from renderer.shells.program import composed, variant_of
from renderer.shells.raster import CELL_DECLARATIONS, Canvas, lit_source, placed_values, seen_faces, switched
from renderer.shells.window import nearest_first

if TYPE_CHECKING:
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

BYTES = 8
"""Of a fragment: its distance, and the face's number."""

LISTS = """layout(std430, binding = 0) readonly buffer Starts { uint list_start[]; };
layout(std430, binding = 1) buffer Ends { uint list_end[]; };
layout(std430, binding = 2) buffer Fragments { vec2 list_fragment[]; }; // distance (m), 4 cell + face
"""

COUNT_BODY = """layout(location = 0) out float one;
void main() {
    one = 1.0;
}"""

FILL_BODY = """layout(early_fragment_tests) in;
void main() {
    int pixel = int(gl_FragCoord.y) * int(picture_size.x) + int(gl_FragCoord.x);
    uint place = atomicAdd(list_end[pixel], 1u);
    list_fragment[place] = vec2(plane_distance(pixel_ray(gl_FragCoord.xy), cell_entry), number);
}"""

RESOLVE_BODY = """layout(location = 0) out vec4 gathered;
void main() {
    int pixel = int(gl_FragCoord.y) * int(picture_size.x) + int(gl_FragCoord.x);
    int first = int(list_start[pixel]), last = int(list_end[pixel]);
    if (first == last) discard;
    order_sort(first, last);
    Ray ray = pixel_ray(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    for (int place = first; place < last && sum.a < OPAQUE; place++) {
        vec2 held = list_fragment[place];
        gather_cell(ray, cell_numbered(ray, max(held.x, 0.0), int(held.y + 0.5)), sum);
        sum = accumulation_kept(sum);
    }
    gathered = buffer_of(sum);
}"""


def draw_lists(frame: Frame, cells: Cells, canvas: Canvas, most: int) -> tuple[int, int]:
    """Draw all cells in the order of each pixel's own list.

    Args:
        most: fragments that there is room for.

    Returns:
        how many fragments there were, and the longest list.

    Raises:
        LimitError: `order.most`, more fragments than that, or than one buffer of this machine holds.
    """
    gl, values = frame.renderer.rasters.gl, placed_values(frame)
    cells.arrange(nearest_first(frame), seen_faces(frame))
    lengths = counted(frame, cells, canvas, values)
    ends = np.cumsum(lengths, dtype=np.int64)
    total = int(ends[-1])
    room = min(most, int(gl.ctx.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"]) // BYTES)
    if total > room:
        refused = f"the picture's lists hold {total:,} fragments, and there is room for {room:,}"
        raise LimitError("order.most", refused, "fewer pixels or cells, or the order walk, which keeps no lists")
    starts = (ends - lengths).astype(np.uint32).tobytes()
    held = [gl.ctx.buffer(starts), gl.ctx.buffer(starts), gl.ctx.buffer(reserve=max(total, 1) * BYTES)]
    try:
        for binding, buffer in enumerate(held):
            buffer.bind_to_storage_buffer(binding)
        canvas.into_gathered.use()
        canvas.into_gathered.color_mask = False, False, False, False
        canvas.into_gathered.depth_mask = False
        with switched(gl, moderngl.DEPTH_TEST | moderngl.CULL_FACE):
            cells.draw(fill_source(frame.state), frame.textures, values)
        gl.ctx.memory_barrier()
        canvas.into_gathered.color_mask = True, True, True, True
        run_fullscreen(gl, resolve_source(frame.state), frame.textures, values)
        gl.finish()
    finally:
        canvas.into_gathered.color_mask = True, True, True, True
        for buffer in held:
            buffer.release()
    return total, int(lengths.max(initial=0))


def counted(frame: Frame, cells: Cells, canvas: Canvas, values: dict[str, Any]) -> np.ndarray:
    """How many fragments each pixel has, (height * width,) int64, bottom row first."""
    gl, (width, height) = frame.renderer.rasters.gl, frame.size
    # Not cleared but made empty: clearing would take the surface's depth along.
    texture = gl.ctx.texture(frame.size, 1, bytes(4 * width * height), dtype="f4")
    target = gl.ctx.framebuffer([texture], canvas.depth)
    target.depth_mask = False
    source = composed((), variant_of(frame.state), (), COUNT_BODY, CELL_DECLARATIONS)
    try:
        target.use()
        with switched(gl, moderngl.DEPTH_TEST | moderngl.CULL_FACE, (moderngl.ONE, moderngl.ONE)):
            cells.draw(source, frame.textures, values)
        gl.finish()
        return np.frombuffer(target.read(components=1, dtype="f4"), np.float32).astype(np.int64)
    finally:
        target.release()
        texture.release()


def fill_source(state: ShellsState) -> Source:
    """The stage that puts fragments into their lists."""
    return composed((), variant_of(state), (), FILL_BODY, CELL_DECLARATIONS + "\n" + LISTS, (4, 3))


def resolve_source(state: ShellsState) -> Source:
    """The stage that sorts a pixel's list and gathers along it."""
    return lit_source(state, RESOLVE_BODY, LISTS)
