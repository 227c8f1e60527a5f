"""What lies at a point of the shells' picture: where a ray comes in, and how much it passes through."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.shells.animation import motion_of
from renderer.shells.animation_scene import moment
from renderer.shells.things import met as things_met
from renderer.shells.things import placed_things
from renderer.world.camera import rays

if TYPE_CHECKING:
    from renderer.shells.state import ShellsState


def probe(
    state: ShellsState, arrays: Mapping[str, Arrays], x: float, y: float, size: tuple[int, int]
) -> dict[str, Any]:
    """Facts about what a ray meets first of the shell.

    Args:
        arrays: of the bakes, by name. x, y: place in the picture, in [0, 1], row 0 at the top. size: (width, height).

    Returns:
        `position` [m] where the ray comes in, `texture`, its coordinates there, `tetrahedra`, how many the ray crosses,
        and `length` inside of them [m]; `thing`, the kind and number of what it meets instead; or `sky` where it meets
        nothing.
    """
    width, height = size
    column, row = min(int(x * width), width - 1), min(int(y * height), height - 1)
    origins, directions = rays(state.camera, width, height, (x * width - column, y * height - row))
    origin, ray = origins[row, column], directions[row, column]
    motion = motion_of(state.motion, state.course)
    shell = moment(arrays["surface"], arrays["shell"], state.extrusion, motion, state.time).shell
    near, far = crossings(shell["planes"], origin, ray)
    met = np.flatnonzero(far > near)
    away, number = _thing(state, arrays, origin, ray)
    if away < np.min(near[met], initial=np.inf):
        place = [round(float(value), 4) for value in origin + away * ray]
        return {"position": place, "thing": f"{number + 1}. {state.things.list[number].kind}"}
    if not len(met):
        return {"sky": True}
    first = met[np.argmin(near[met])]
    point = origin + near[first] * ray
    place = shell["to_texture"][first] @ np.append(point, 1.0)
    return {
        "position": [round(float(value), 4) for value in point],
        "texture": [round(float(value), 4) for value in place],
        "tetrahedra": len(met),
        "length": round(float((far - near)[met].sum()), 4),
    }


def _thing(
    state: ShellsState, arrays: Mapping[str, Arrays], origin: np.ndarray, ray: np.ndarray
) -> tuple[float, int]:
    """Distance [m] and number of the first other mesh that a ray meets."""
    if "things" not in arrays:
        return np.inf, -1
    return things_met(placed_things(state.things, arrays["things"]), origin, ray)


def crossings(planes: np.ndarray, origin: np.ndarray, ray: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances (T,) [m] at which a ray comes into cells and leaves them, the latter no greater where it misses.

    Args:
        planes: (T, 4, 4), outwards. origin: (3,) [m]. ray: (3,) unit vector.
    """
    height, fall = planes[..., :3] @ origin + planes[..., 3], planes[..., :3] @ ray
    with np.errstate(divide="ignore", invalid="ignore"):
        at = -height / fall
    near = np.where(fall < 0, at, -np.inf).max(axis=1)
    far = np.where(fall > 0, at, np.inf).min(axis=1)
    outside = ((fall == 0) & (height > 0)).any(axis=1)
    return np.maximum(near, 0.0), np.where(outside, -np.inf, far)
