"""Worlds in which every order is put to the same questions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

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


def difference(draw: Draw, order: dict[str, Any], world: dict[str, Any], size: int = 48) -> np.ndarray:
    """By how much each pixel differs from the walk's, the greatest of its channels."""
    block = patches()
    return np.abs(draw({**world, **order}, block, size=size) - draw(world, block, size=size)).max(axis=-1)
