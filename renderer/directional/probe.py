"""What lies at a point of the picture: the mesh that is hit, and where a ray comes into the box."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.casting import face_frame
from renderer.directional.hemisphere import hemisphere_of
from renderer.world.camera import rays

if TYPE_CHECKING:
    from renderer.directional.state import DirectionalState


def probe(
    state: DirectionalState, arrays: Mapping[str, Arrays], x: float, y: float, size: tuple[int, int]
) -> dict[str, Any]:
    """Facts about a point of the picture.

    Args:
        arrays: of the bakes, by name. x, y: place in the picture, in [0, 1], row 0 at the top. size: (width, height).

    Returns:
        `face`, `place` [m] and `direction`, the number of the nearest in the face's hemisphere, of the ray's way into
        the box, and `points`, how many the cloud has; or `sky` where it misses.
    """
    width, height = size
    column, row = min(int(x * width), width - 1), min(int(y * height), height - 1)
    origins, directions = rays(state.camera, width, height, (x * width - column, y * height - row))
    origin, ray = origins[row, column], directions[row, column]
    box = np.asarray(arrays["visibility"]["box"], np.float64)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = (box - origin) / ray
    near, far = np.nanmax(at.min(axis=0)), np.nanmin(at.max(axis=0))
    if not 0 < near < far:
        return {"sky": True}
    axis = int(np.nanargmax(at.min(axis=0)))
    face = 2 * axis + int(ray[axis] < 0)
    layout = hemisphere_of(state.visibility.directions)
    return {
        "face": ("-x", "+x", "-y", "+y", "-z", "+z")[face],
        "place": [round(float(value), 4) for value in origin + near * ray],
        "direction": int(layout.nearest(face_frame(face) @ -ray)),
        "points": len(arrays["visibility"]["used"]),
    }
