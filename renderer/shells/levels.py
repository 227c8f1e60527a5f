"""Which levels of the texture a view reads: near ones the finest alone, and need neither a filter nor levels."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from renderer.shells.filter.none import NoFilter
from renderer.world.camera import Orthographic, pose

if TYPE_CHECKING:
    from renderer.shells.resident import Placed
    from renderer.shells.state import ShellsState


def suited(state: ShellsState, place: Placed, shape: Sequence[int], size: tuple[int, int]) -> ShellsState:
    """The state, without its filter where not even the farthest place would be read at a coarser level.

    Args:
        place: where the shell stands. shape: of the texture, (K, J, I). size: of the picture, pixels.
    """
    bias = getattr(state.filter, "bias", None)
    if bias is None or coarsest(state, place, shape, size) + bias > 0:
        return state
    return state.model_copy(update={"filter": NoFilter()})


def coarsest(state: ShellsState, place: Placed, shape: Sequence[int], size: tuple[int, int]) -> float:
    """Level whose voxels are as wide as a pixel of the camera or of the sun's picture at the farthest place of the
    shell, at most; of no bias, and below 0 for voxels that are wider."""
    away = float(np.linalg.norm(pose(state.camera).eye - place.centre)) + place.radius
    voxels = float((place.steepest * (shape[2], shape[1])).min(axis=1).max())
    sun = 2.02 * place.radius / getattr(state.shadow, "resolution", math.inf)
    angle, side = pixel(state, size)
    return math.log2(max(voxels * max(side + angle * away, sun), 1e-9))


def sides(place: Placed, shape: Sequence[int]) -> tuple[float, float]:
    """Sides of a voxel along u and v [m]: the median of the shell's, in steps of a quarter of an octave, so that a
    surface which moves a little keeps its texture."""
    u, v = (-math.log2(max(float(np.median(place.gradients[:, k])) * shape[2 - k], 1e-9)) for k in range(2))
    return 2 ** (round(4 * u) / 4), 2 ** (round(4 * v) / 4)


def pixel(state: ShellsState, size: tuple[int, int]) -> tuple[float, float]:
    """How wide a pixel is: an angle [rad] in perspective, a length [m] in a parallel view; the other is 0."""
    if isinstance(state.camera, Orthographic):
        return 0.0, state.camera.width / size[0]
    return 2 * math.tan(math.radians(state.camera.field_of_view) / 2) / size[1], 0.0
