"""Pairs of normals, and the cosines to a sun: what the light techniques are held to."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.forest.light.gouraud import Gouraud
from renderer.forest.light.lambert import Lambert
from renderer.world.sun import direction
from tests.forest import worlds

RNG = np.random.default_rng(12)
COUNT = 500


def normals() -> tuple[np.ndarray, np.ndarray]:
    """Unit normals of voxels (any direction) and of the ground (upwards)."""
    voxel, ground = RNG.normal(size=(2, COUNT, 3))
    ground[:, 2] = np.abs(ground[:, 2])
    return tuple(n / np.linalg.norm(n, axis=1, keepdims=True) for n in (voxel, ground))  # type: ignore[return-value]


def light_error(
    ask: Callable[..., np.ndarray], technique: Gouraud | Lambert,
    twin: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray],
) -> float:
    """Worst error of the light factor against `twin(voxel normal, ground normal, sun)`, over suns and normals."""
    worst = 0.0
    for azimuth, elevation in ((0, 90), (70, 30), (200, 5), (310, -10)):
        state = worlds.state(sun=worlds.sun(azimuth, elevation))
        voxel, ground = normals()
        found = ask([f"forest/light/{technique.kind}.glsl"], "light_factor(voxel, ground)",
                    {"voxel": voxel, "ground": ground}, techniques={"light": technique}, state=state)[:, 0]
        assert (found >= 0).all()
        worst = max(worst, float(np.abs(found - twin(voxel, ground, np.asarray(direction(state.sun)))).max()))
    return worst
