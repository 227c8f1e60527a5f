"""Leaves of every kind and direction, and what they send of a sun: what the light techniques are held to."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from renderer.forest.technique import ForestTechnique
from renderer.world.sun import direction
from tests.forest import worlds

COUNT = 500
SUNS = ((0, 90), (70, 30), (200, 5), (310, -10))


class Leaves(NamedTuple):
    """Leaves of N voxels, seen from one direction each: (N, 3) or, `flatness`, (N,)."""

    albedo: np.ndarray
    passed: np.ndarray
    normal: np.ndarray
    flatness: np.ndarray
    slope: np.ndarray
    to_eye: np.ndarray


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) at length one."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def drawn(count: int = COUNT) -> Leaves:
    """Voxels of every kind: any direction, any disorder, on any slope."""
    rng = np.random.default_rng(12)
    normal, slope, to_eye = unit(rng.normal(size=(3, count, 3)))
    slope[:, 2] = np.abs(slope[:, 2])
    flatness = rng.uniform(size=count)
    flatness[: count // 10], flatness[-count // 10 :] = 0, 1
    return Leaves(*rng.uniform(0, 0.5, (2, count, 3)), normal, flatness, slope, to_eye)


MATTER = "Matter(albedo, passed, normal, flatness, slope, vec3(0.5), 0.0)"
Twin = Callable[[Leaves, np.ndarray], np.ndarray]


def sent(
    ask: Callable[..., np.ndarray], technique: ForestTechnique, leaves: Leaves, sun: Any, **more: Any
) -> np.ndarray:
    """Radiance per irradiance of the sun that a light technique's shader gives, (N, 3)."""
    files = ["forest/matter.glsl", f"forest/light/{technique.kind}.glsl"]
    return ask(files, f"light_reflected({MATTER}, to_eye)", leaves._asdict(), 3, techniques={"light": technique},
               state=worlds.state(sun=sun), **more)


def light_error(ask: Callable[..., np.ndarray], technique: ForestTechnique, twin: Twin, **more: Any) -> float:
    """Worst error of what a light technique sends against `twin(leaves, sun)`, over suns and leaves."""
    worst = 0.0
    for azimuth, elevation in SUNS:
        sun = worlds.sun(azimuth, elevation)
        leaves = drawn()
        found = sent(ask, technique, leaves, sun, **more)
        assert (found >= 0).all()
        towards = np.asarray(direction(worlds.state(sun=sun).sun))
        worst = max(worst, float(np.abs(found - twin(leaves, towards)).max()))
    return worst
