"""Worlds in which every order is put to the same questions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.shells.base_mesh import BaseMesh
from renderer.shells.order_bench import arrays_of
from renderer.shells.shell import Shell, build_shell
from renderer.world.camera import Orbit, rays
from tests.shells.conftest import even, sigma
from tests.shells.order.test_walk import GLOBE, hollow_sphere

Draw = Callable[..., np.ndarray]


def ordered(kind: str, **parameters: Any) -> dict[str, Any]:
    """A patch of a document that chooses an order."""
    return {"order": {"kind": kind, **parameters}}


def two_layers(draw: Draw, order: dict[str, Any]) -> np.ndarray:
    """Red over blue, each of opacity 0.6, as the middle pixel shows them (erratum 002-3): [0.6, 0, 0.24, 0.84]."""
    block = even(1 - 0.4 ** (0.1 / 0.25), layers=2)
    block[0, ..., :3], block[1, ..., :3] = (0, 0, 1), (1, 0, 0)
    return np.asarray(draw({"voxels": {"interpolation": "nearest", "storage": "float"}, **order}, block)[4, 4])


def absorber_error(draw: Draw, order: dict[str, Any], size: int = 12) -> float:
    """Worst error of the opacity of an even absorber over a hollow sphere, against intervals of every cell."""
    alpha = draw({**GLOBE, **order}, even(0.02), size=size)[..., 3]
    origins, directions = rays(Orbit(**GLOBE["camera"]), size, size)
    length = hollow_sphere(origins.reshape(-1, 3), directions.reshape(-1, 3)).reshape(size, size)
    return float(np.abs(alpha - (1 - np.exp(-sigma(0.02) * length))).max())


def patches(seed: int = 3) -> np.ndarray:
    """Semi-transparent matter of many colours, which shows every mistake of order."""
    block = np.random.default_rng(seed).uniform(0, 1, (4, 8, 8, 4)).astype(np.float32)
    block[..., 3] = 0.2 + 0.5 * block[..., 3]
    return block


def difference(
    draw: Draw, order: dict[str, Any], world: dict[str, Any], size: int = 48, shell: Shell | None = None
) -> np.ndarray:
    """By how much each pixel differs from the walk's, the greatest of its channels."""
    given = None if shell is None else arrays_of(shell)
    one, other = (draw(of, patches(), size=size, shell=given) for of in ({**world, **order}, world))
    return np.asarray(np.abs(one - other).max(axis=-1))


CYCLE = {
    "camera": {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 2.4}
}
"""A view from above."""


def bars(turns: int = 3) -> Shell:
    """Long prisms that rise from one end to the other, each laid over the next one's low end: they have no order."""
    points, faces = [], []
    for turn in range(turns):
        angle = 2 * np.pi * turn / turns
        along, across = np.array([np.cos(angle), np.sin(angle), 0]), np.array([-np.sin(angle), np.cos(angle), 0])
        middle = -0.45 * across
        low, high = middle - 1.0 * along, middle + 1.0 * along + np.array([0, 0, 0.8])
        faces.append(np.arange(3) + len(points))
        points += [low - 0.12 * across, high, low + 0.12 * across]
    vertices = np.array(points)
    uv = np.tile(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), (turns, 1, 1))
    mesh = BaseMesh(vertices, np.array(faces, np.int32), uv)
    return build_shell(mesh, np.tile([0.0, 0.0, 0.1], (len(vertices), 1)))
