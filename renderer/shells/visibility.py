"""The visibility order of a shell's cells: Cook, Max, Silva & Williams 2004, "Image-space visibility ordering for cell
projection volume rendering of unstructured data" (SXMPVO).

Cells that share a face are ordered by the side of it on which the eye is (Williams 1992). Cells that do not, but follow
each other along a ray, leave the mesh and come back into it: the faces of its boundary are scan-converted into a list
per pixel, sorted by depth, and where one cell is left and the next one entered, the first hides the second. A sort by
these relations (Kahn 1962) is the order. Erratum 002-6: relations point from what hides to what is hidden.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.shells.cells import facing
from renderer.shells.frame import reach
from renderer.shells.resident import Placed
from renderer.shells.visibility_kernels import fragments, neighbours_in_depth, sorted_cells
from renderer.world.projection import view_projection

if TYPE_CHECKING:
    from renderer.shells.frame import Frame

TOLD = 256
"""Cells of cycles that are named."""

OF_A_FACE = 1e9
"""Cost of giving up the relation of two cells that share a face, in pixels: more than any picture has."""


@dataclass(frozen=True)
class Order:
    """Cells in the order of visibility.

    Attributes:
        cells: (T,) int32, front to back.
        relations: how many were found, each once. of_pixels: those of them that no shared face gives.
        cycles: how many were broken. cyclic: cells of the first ones, each in front of the next, the last of the first.
    """

    cells: np.ndarray
    relations: int
    of_pixels: int
    cycles: int
    cyclic: tuple[tuple[int, ...], ...]


def visibility_order(shell: Arrays, place: Placed, camera: Any, size: tuple[int, int]) -> Order:
    """The order in which a camera sees a shell's cells.

    A cycle has no order: the relation that the fewest pixels show is given up, one of a shared face only where there is
    no other.

    Args:
        shell: arrays of its bake. place: where it stands. camera: any.
        size: (width, height) in pixels of the lists; what falls between pixels is not ordered.
    """
    count = len(shell["tets"])
    near = facing(shell, camera)
    before, after, pixels = shared_faces(shell["neighbour"], near)
    beyond = pixel_relations(shell, place, camera, size, near)
    of_pixels = len(beyond[0])
    told = np.full(TOLD, -1, np.int32)
    before, after = np.concatenate([before, beyond[0]]), np.concatenate([after, beyond[1]])
    order, cycles = sorted_cells(before, after, np.concatenate([pixels, beyond[2]]), count, told)
    return Order(order, len(before), of_pixels, cycles, _spoken(told))


def sorted_for(frame: Frame, fineness: float) -> Order:
    """The order of a frame's cells, kept while shell, camera and size stay."""
    width, height = (max(1, round(side * fineness)) for side in frame.size)
    key = (frame.shell_key, frame.state.camera, width, height)
    kept = frame.renderer.rasters.kept
    if kept.get("sxmpvo", (None,))[0] != key:
        found = visibility_order(frame.arrays["shell"], frame.place, frame.state.camera, (width, height))
        kept["sxmpvo"] = key, found
    order: Order = kept["sxmpvo"][1]
    return order


def shared_faces(neighbour: np.ndarray, near: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Relations of cells that share a face: before, after (N,) int32, and cost (N,).

    Args:
        neighbour: (T, 4). near: (T, 4) bool, faces that turn to the eye: what lies across them is in front.
    """
    behind, face = np.nonzero(near & (neighbour >= 0))
    front = neighbour[behind, face]
    return front.astype(np.int32), behind.astype(np.int32), np.full(len(front), OF_A_FACE)


def pixel_relations(
    shell: Arrays, place: Placed, camera: Any, size: tuple[int, int], near: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Relations of cells that follow each other in a pixel without sharing a face: before, after, and in how many
    pixels."""
    cell, face = np.nonzero(shell["neighbour"] < 0)
    others = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])[face]
    corners = shell["positions"][shell["tets"][cell[:, None], others]] - place.centre
    matrix = view_projection(camera, size, (0.5, 0.5), place.centre, reach(camera, place))
    clip = np.concatenate([corners, np.ones((*corners.shape[:2], 1))], axis=-1) @ matrix.T
    start, depth, triangle = fragments(clip, size[0], size[1])
    count = len(shell["tets"])
    before, after, pixels = neighbours_in_depth(
        start, depth, triangle, cell.astype(np.int32), near[cell, face], count
    )
    code, which = np.unique(before.astype(np.int64) * count + after, return_inverse=True)
    total = np.bincount(which, weights=pixels, minlength=len(code))
    return (code // count).astype(np.int32), (code % count).astype(np.int32), total


def _spoken(told: np.ndarray) -> tuple[tuple[int, ...], ...]:
    """Cycles as `sorted_cells` tells them: each led by the number of its cells."""
    cycles, at = [], 0
    while at < len(told) and told[at] > 0:
        cycles.append(tuple(int(cell) for cell in told[at + 1:at + 1 + told[at]]))
        at += 1 + int(told[at])
    return tuple(cycles)
