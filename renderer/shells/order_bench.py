"""The thesis' charts of orders again: peeling against layers of depth, SXMPVO against the number of cells.

Dufort 2005, figures 4.3, 4.4 and 4.6. Times are of the CPU, all threads together, whatever else a machine does.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays, BakedArrays
from renderer.gl.context import GL
from renderer.gl.targets import Target
from renderer.shells.base_mesh import BaseMesh, from_corners
from renderer.shells.order_errors import order_error
from renderer.shells.renderer import ShellsRenderer
from renderer.shells.resident import placed
from renderer.shells.shell import Shell, build_shell
from renderer.shells.shell_bake import GEOMETRY
from renderer.shells.surface_grids import grid_corners, grid_uv
from renderer.shells.surfaces import Sphere
from renderer.shells.visibility import visibility_order
from renderer.world.camera import Orbit
from renderer.world.mesh_normals import vertex_normals

if TYPE_CHECKING:
    from renderer.shells.state import ShellsState

LAYERS = (1, 2, 4, 8)
"""Sheets over each other, three cells deep each: figures 4.3 and 4.4 go to some ten layers."""

DIVISIONS = (2, 3, 5, 8, 12, 17, 24)
"""Of the hollow sphere, from 144 cells to 20,736: the thesis goes from 48 to 4,750, which have 19,000 triangles."""

DRIFTS = (0.0, 1.0, 2.0, 5.0, 10.0, 20.0)
"""Degrees by which a camera has moved since its order was found."""

CAMERA = Orbit(target=(0, 0, 0), distance=3, azimuth=30, elevation=9, field_of_view=40)


def sheets(layers: int, cells: int, gap: float = 0.1) -> Shell:
    """Level squares of side 1 over each other, that hold a number of cells in all and cover the same pixels.

    Args:
        layers: squares. cells: in all, at least; each square is cut as finely as that takes. gap: between squares [m].
    """
    side = max(1, round((cells / (6 * layers)) ** 0.5))
    corners, uv = [], []
    for layer in range(layers):
        x, y = np.meshgrid(np.linspace(-0.5, 0.5, side + 1), np.linspace(-0.5, 0.5, side + 1))
        nodes = np.stack([x, y, np.full_like(x, layer * gap)], axis=-1)
        places, coordinates = grid_corners(nodes, grid_uv(side, side, 1, 1))
        corners.append(places)
        uv.append(coordinates)
    mesh = from_corners(np.concatenate(corners), np.concatenate(uv))
    return build_shell(mesh, np.tile([0.0, 0.0, 0.5 * gap], (len(mesh.vertices), 1)))


def hollow_sphere(divisions: int) -> Shell:
    """The shell over a sphere of radius 1 and a tenth thick."""
    mesh: BaseMesh = Sphere(radius=1.0, divisions=divisions).mesh()
    return build_shell(mesh, 0.1 * vertex_normals(mesh.vertices, mesh.faces))


def arrays_of(shell: Shell) -> dict[str, np.ndarray]:
    """A shell as its bake gives it to the renderer."""
    edges = shell.edges
    return {name: getattr(shell, name) for name in GEOMETRY} | {
        "counts": np.array([edges.open, edges.crowded, edges.turned])
    }


def sort_times(divisions: Sequence[int] = DIVISIONS, side: int = 512, turns: int = 3) -> list[dict[str, float]]:
    """How long SXMPVO sorts a hollow sphere of more and more cells.

    Args:
        divisions: of the sphere. side: of the pixels' lists. turns: of which the quickest counts.

    Returns:
        rows of `cells`, `relations`, `of_pixels` (those that no shared face gives), `cycles` and `ms`.
    """
    rows = []
    for division in divisions:
        shell = arrays_of(hollow_sphere(division))
        place = placed(shell)
        spent, found = quickest(lambda: visibility_order(shell, place, CAMERA, (side, side)), turns)  # noqa: B023
        rows.append(
            {
                "cells": len(shell["tets"]),
                "relations": found.relations,
                "of_pixels": found.of_pixels,
                "cycles": found.cycles,
                "ms": spent,
            }
        )
    return rows


class Drawer:
    """Draws shells that are handed to it, on the GL thread.

    Args:
        gl: the context's objects. state: the document. baked: what it needs baked, whose shell is replaced.
        side: of the picture [px].
    """

    def __init__(self, gl: GL, state: ShellsState, baked: Mapping[str, BakedArrays], side: int) -> None:
        self._gl, self._state, self._baked = gl, state, baked
        self._renderer, self._target = ShellsRenderer(gl), Target(gl, side, side)

    def __call__(self, shell: Arrays) -> dict[str, Any]:
        """Draw a shell, finish, and return what its order counted."""
        key = hashlib.sha256(np.ascontiguousarray(shell["positions"]).tobytes()).hexdigest()
        baked = {**self._baked, "shell": BakedArrays(key, shell)}
        size = (self._target.width, self._target.height)
        prepared = self._renderer.prepare(self._state, baked, size, (0.5, 0.5), 0)
        self._target.use()
        self._renderer.draw(prepared)
        self._gl.finish()
        return self._renderer.rasters.said

    def release(self) -> None:
        """Free its objects."""
        self._renderer.release()
        self._target.release()


def peel_times(
    draw: Callable[[Arrays], Mapping[str, Any]], cells: int = 1536, layers: Sequence[int] = LAYERS, turns: int = 3
) -> list[dict[str, float]]:
    """How long peeling takes for the same cells over the same pixels in more and more layers.

    Args:
        draw: a `Drawer` whose document peels, seen from above.
        cells: of each shell, nearly. layers: sheets. turns: of which the quickest counts.

    Returns:
        rows of `sheets`, `cells`, `passes` and `ms`.
    """
    rows = []
    for count in layers:
        shell = arrays_of(sheets(count, cells))
        draw(shell)
        spent, said = quickest(lambda: draw(shell), turns)  # noqa: B023
        rows.append({"sheets": count, "cells": len(shell["tets"]), "passes": said["passes"], "ms": spent})
    return rows


def drift_errors(
    draw: Callable[[float], tuple[np.ndarray, int]],
    exact: Callable[[float], np.ndarray],
    degrees: Sequence[float] = DRIFTS,
) -> list[dict[str, float]]:
    """How wrong an order becomes that was sorted for a camera a while ago: Dufort 2005, section 4.3.1.

    Args:
        draw: the picture (H, W, 4) of a camera turned by an angle [deg], and its pixels out of order. It is asked for 0
            first, and keeps the order that it finds there.
        exact: the same picture in the exact order. degrees: angles.

    Returns:
        rows of `degrees`, `out_of_order`, `wrong` and `relative_rmse`, those of `order_error`.
    """
    draw(0.0)
    rows = []
    for angle in degrees:
        picture, late = draw(angle)
        error = order_error(picture, exact(angle))
        rows.append(
            {
                "degrees": angle,
                "out_of_order": late,
                "wrong": error.wrong,
                "relative_rmse": error.relative_rmse,
            }
        )
    return rows


def quickest(work: Callable[[], Any], turns: int) -> tuple[float, Any]:
    """Least CPU time [ms] of a piece of work, and what it gave."""
    least, found = float("inf"), None
    for _ in range(turns):
        started = time.process_time()
        found = work()
        least = min(least, 1e3 * (time.process_time() - started))
    return least, found
