"""The first sample of a picture: fewer rays than pixels, and smoothed between them.

It is what is shown while the camera moves, where each ray would be followed anew. Rays of neighbouring pixels tell
nearly the same, and what they differ in is mostly noise: half as many, each lit at more places and smoothed, are nearer
to the picture than one for each pixel. It is one of the samples of the mean, from which its smoothing fades.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import moderngl

from renderer.shells.traced import lit_along_traces

if TYPE_CHECKING:
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

CORNERS = {1: ((0.5, 0.5),), 2: ((0.0, 0.0), (1.0, 1.0))}
"""By the number of rays of two by two pixels: where in them each is, pixels from the top-left one."""


def rays_of_blocks(frame: Frame, state: ShellsState, rays: int, inside: bool) -> dict[str, AnyTexture]:
    """Light and opacity of some rays of each two by two pixels: `gathered_0` and so on, a ray of each block in each.

    Args:
        frame: of the picture. state: by which its rays are followed. rays: of a block.
        inside: whether the camera is within a cell.
    """
    gathered: dict[str, AnyTexture] = {}
    for number, corner in enumerate(CORNERS[rays]):
        part = frame.coarser(corner, state)
        texture = lit_along_traces(part, part.entries(), inside)
        texture.filter = moderngl.LINEAR, moderngl.LINEAR
        texture.repeat_x = texture.repeat_y = False
        gathered[f"gathered_{number}"] = texture
    return gathered
