"""The first sample of a picture: fewer rays than pixels, and smoothed between them.

It is what is shown while the camera moves, where each ray would be followed anew. Rays of neighbouring pixels tell
nearly the same, and what they differ in is mostly noise: half as many, each lit at more places and smoothed, are nearer
to the picture than one for each pixel. It is one of the samples of the mean, from which its smoothing fades.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import moderngl

from renderer.shells.lattice import every_fourth, every_second
from renderer.shells.traced import lit_along_traces

if TYPE_CHECKING:
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

LATTICES = {1: every_fourth, 2: every_second}
"""By the number of rays of two by two pixels."""


def rays_of_some(frame: Frame, state: ShellsState, rays: int, inside: bool) -> tuple[moderngl.Texture, dict[str, Any]]:
    """Light and opacity of some rays of each two by two pixels, and the uniforms by which they are laid out.

    Args:
        frame: of the picture. state: by which its rays are followed. rays: of two by two pixels.
        inside: whether the camera is within a cell.
    """
    lattice = LATTICES[rays](frame.size, frame.offset)
    part = frame.sparser(lattice, state)
    texture = lit_along_traces(part, part.entries(), inside)
    texture.filter = moderngl.LINEAR, moderngl.LINEAR
    texture.repeat_x = texture.repeat_y = False
    return texture, {"first_before": lattice.size[0] - -(-frame.size[0] // 2)}
