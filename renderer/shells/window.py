"""Cells drawn through windows of k fragments a pixel: Callahan, Ikits, Comba & Silva 2005; Dufort 2005, 4.3.1."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import moderngl
import numpy as np

from renderer.core.errors import LimitError
from renderer.gl.source import Source
from renderer.gl.targets import run_fullscreen
from renderer.shells.cells import Cells
from renderer.shells.raster import CELL_DECLARATIONS, UNDER, Canvas, lit_source, placed_values, seen_faces, switched
from renderer.shells.visibility import sorted_for
from renderer.world.camera import Orthographic, pose

if TYPE_CHECKING:
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

EMPTY = (-1e30, -1.0)
"""A place of a window without a fragment, as in shaders/shells/order/k_buffer.glsl."""

WINDOWS = """layout(std430, binding = 0) buffer Windows { vec2 window_held[]; }; // distance (m), 4 cell + face
layout(std430, binding = 1) buffer Lasts { float window_last[]; };
layout(std430, binding = 2) buffer Wrongs { uint window_wrong[]; };
"""

THROUGH_BODY = """layout(early_fragment_tests) in;
layout(location = 0) out vec4 gathered;
void main() {
    int pixel = int(gl_FragCoord.y) * int(picture_size.x) + int(gl_FragCoord.x);
    Ray ray = pixel_ray(gl_FragCoord.xy);
    vec2 held = order_through(pixel, vec2(plane_distance(ray, cell_entry), number));
    vec4 sum = vec4(0.0);
    if (held.y >= 0.0) {
        order_leaves(pixel, held);
        gather_cell(ray, cell_numbered(ray, max(held.x, 0.0), int(held.y + 0.5)), sum);
    }
    gathered = buffer_of(sum);
}"""

REST_BODY = """layout(location = 0) out vec4 gathered;
void main() {
    int pixel = int(gl_FragCoord.y) * int(picture_size.x) + int(gl_FragCoord.x);
    Ray ray = pixel_ray(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    for (int turn = 0; turn < ORDER_K; turn++) {
        vec2 held = order_through(pixel, vec2(1.0e30, -1.0));
        if (held.y >= 0.0) {
            order_leaves(pixel, held);
            gather_cell(ray, cell_numbered(ray, max(held.x, 0.0), int(held.y + 0.5)), sum);
            sum = accumulation_kept(sum);
        }
    }
    gathered = buffer_of(sum);
}"""


def draw_through_windows(frame: Frame, cells: Cells, canvas: Canvas, order: np.ndarray, k: int) -> int:
    """Draw all cells through the windows, and then what is left in them.

    Args:
        order: (T,) cells, roughly front to back. k: fragments of a window.

    Returns:
        In how many pixels something came more than k places too late.

    Raises:
        LimitError: `order.k`, windows that no buffer of this machine holds.
    """
    gl, values, pixels = frame.renderer.rasters.gl, placed_values(frame), frame.size[0] * frame.size[1]
    check_room(pixels, k, int(gl.ctx.info["GL_MAX_SHADER_STORAGE_BLOCK_SIZE"]))
    empty = np.tile(np.array(EMPTY, np.float32), pixels * k).tobytes()
    last = np.full(pixels, -1e30, np.float32).tobytes()
    held = [gl.ctx.buffer(empty), gl.ctx.buffer(last), gl.ctx.buffer(bytes(4 * pixels))]
    cells.arrange(order, seen_faces(frame))
    try:
        for binding, buffer in enumerate(held):
            buffer.bind_to_storage_buffer(binding)
        canvas.into_gathered.use()
        canvas.into_gathered.depth_mask = False
        with switched(gl, moderngl.DEPTH_TEST | moderngl.CULL_FACE, UNDER):
            cells.draw(through_source(frame.state), frame.textures, values)
        gl.ctx.memory_barrier()
        with switched(gl, moderngl.NOTHING, UNDER):
            run_fullscreen(gl, rest_source(frame.state), frame.textures, values)
        gl.finish()
        return int(np.count_nonzero(np.frombuffer(held[2].read(), np.uint32)))
    finally:
        for buffer in held:
            buffer.release()


def check_room(pixels: int, k: int, room: int) -> None:
    """Refuse windows that do not fit into `room` bytes.

    Raises:
        LimitError: `order.k`.
    """
    needed = pixels * k * 8
    if needed > room:
        refused = f"windows of {k} fragments for {pixels:,} pixels need {needed:,} bytes, and {room:,} fit"
        raise LimitError("order.k", refused, f"at most {room // (8 * pixels)} here")


def through_source(state: ShellsState) -> Source:
    """The stage that puts a fragment into its pixel's window and gathers along the one that falls out."""
    return lit_source(state, THROUGH_BODY, CELL_DECLARATIONS + "\n" + WINDOWS)


def rest_source(state: ShellsState) -> Source:
    """The stage that gathers along what is left in the windows."""
    return lit_source(state, REST_BODY, WINDOWS)


def nearest_first(frame: Frame) -> np.ndarray:
    """Cells by the distance of their middles, (T,)."""
    shell, camera = frame.arrays["shell"], frame.state.camera
    middles, at = shell["positions"][shell["tets"]].mean(axis=1), pose(camera)
    if isinstance(camera, Orthographic):
        return np.argsort(middles @ at.forward)
    return np.argsort(((middles - at.eye) ** 2).sum(axis=1))


def sorted_before(frame: Frame, drift: float) -> np.ndarray:
    """SXMPVO's order of the last camera that it was found for, anew where that is farther off than `drift` degrees."""
    kept = frame.renderer.rasters.kept
    if "k_buffer" not in kept or kept["k_buffer"][0] != frame.shell_key or moved_by(frame) > drift:
        kept["k_buffer"] = frame.shell_key, frame.state.camera, sorted_for(frame, 1.0).cells
    cells: np.ndarray = kept["k_buffer"][2]
    return cells


def moved_by(frame: Frame) -> float:
    """How far the camera is from where the kept order was found, as seen from the middle of the shell [deg]."""
    kept = frame.renderer.rasters.kept
    if "k_buffer" not in kept:
        return 0.0
    then, now = pose(kept["k_buffer"][1]), pose(frame.state.camera)
    if isinstance(frame.state.camera, Orthographic):
        return math.degrees(math.acos(float(np.clip(then.forward @ now.forward, -1, 1))))
    away = max(float(np.linalg.norm(now.eye - frame.place.centre)), 1e-9 * frame.place.radius)
    return math.degrees(float(np.linalg.norm(now.eye - then.eye)) / away)
