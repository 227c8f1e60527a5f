"""The matrix by which triangles are drawn where a camera's rays meet them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from renderer.world.camera import Orthographic, pose


def view_projection(
    camera: Any, size: tuple[int, int], offset: tuple[float, float], centre: np.ndarray, reach: tuple[float, float]
) -> np.ndarray:
    """World to OpenGL's clip coordinates, (4, 4) float64, such that the middle of each fragment lies on the ray of its
    pixel through `offset`: the twin of `rays` in `renderer.world.camera`.

    Args:
        camera: any. size: (width, height) in pixels.
        offset: of the sample inside its pixel, from the top-left corner; the middle is (0.5, 0.5).
        centre: (3,), taken for the origin of the triangles' coordinates [m].
        reach: nearest and farthest distance ahead of the camera that is drawn [m].
    """
    width, height = size
    at = pose(camera)
    eye = at.eye - centre
    shift_x, shift_y = (1 - 2 * offset[0]) / width, -(1 - 2 * offset[1]) / height
    near, far = reach
    ahead = np.append(at.forward, -at.forward @ eye)
    right, up = np.append(at.right, -at.right @ eye), np.append(at.up, -at.up @ eye)
    if isinstance(camera, Orthographic):
        pixel = camera.width / width
        whole = np.array([0.0, 0.0, 0.0, 1.0])
        depth = (2 * ahead - (far + near) * whole) / (far - near)
    else:
        pixel = 2 * math.tan(0.5 * math.radians(camera.field_of_view)) / height
        whole = ahead
        depth = ((far + near) * ahead - np.array([0.0, 0.0, 0.0, 2 * far * near])) / (far - near)
    return np.stack(
        [
            right * 2 / (pixel * width) + shift_x * whole,
            up * 2 / (pixel * height) + shift_y * whole,
            depth,
            whole,
        ]
    )
