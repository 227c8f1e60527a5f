"""Rays through slabs of one opacity: what the geometry techniques are held to."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from renderer.forest.geometry.ray_march import RayMarch
from renderer.forest.geometry.slices import Slices
from renderer.forest.world_scale import CANOPY_HEIGHT, NODES, VOXEL
from tests.forest import worlds

ALPHA = 12
HALF = 100.0
RAYS = 2048
NOISE = 2.0 / RAYS + 1e-3
"""Of a share counted over stratified rays: two rays, and a thousandth for float32."""

FILES = ("forest/crossing.glsl", "forest/events.glsl", "forest/filter/none.glsl")

TRACE = """Event event = no_event(xi);
geometry_trace(origin, direction, 0.0, vec4(jitter, xi, 0.5, 0.5), event);
result = vec4(event.place.w == GROUND ? 1.0 : 0.0, event.opacity, event.place.w, event.place.z);"""


def strata() -> tuple[np.ndarray, np.ndarray]:
    """Levels and jitters that cover [0, 1) evenly together."""
    n = np.arange(RAYS)
    return ((n + 0.5) / RAYS).astype(np.float32), ((n * 0.6180339887498949) % 1).astype(np.float32)


def plane(slope: float) -> dict[str, np.ndarray]:
    """Wooded ground that rises `slope` metres a metre to the east around the middle, and is level beyond `HALF`."""
    x = np.clip((np.arange(NODES) - (NODES - 1) / 2) * 8.0, -HALF, HALF)[None, :]
    return worlds.ground(x * slope + HALF * abs(slope))


def trace(
    ask: Callable[..., np.ndarray], technique: Slices | RayMarch, origin: Any, direction: Any,
    pattern: Mapping[str, np.ndarray], terrain: Mapping[str, np.ndarray] | None = None, local: bool = False,
) -> np.ndarray:
    """Whether each ray looks at the light on the ground, its opacity, and height and z of that place: (RAYS, 4)."""
    xi, jitter = strata()
    d = np.asarray(direction, float) / np.linalg.norm(direction)
    inputs = {"xi": xi, "jitter": jitter, "origin": np.tile(np.asarray(origin, np.float32), (RAYS, 1)),
              "direction": np.tile(d.astype(np.float32), (RAYS, 1))}
    file = f"forest/geometry/{technique.kind}.glsl"
    return ask([*FILES, file], TRACE, inputs, 4, techniques={"geometry": technique}, pattern=pattern, terrain=terrain,
               local=local)


def slab_error(
    ask: Callable[..., np.ndarray], technique: Slices | RayMarch, direction: Any, slope: float = 0.0
) -> float:
    """Error of the transmittance from the canopy's top to the ground, against (1 - alpha)^(path / voxel)."""
    d = np.asarray(direction, float) / np.linalg.norm(direction)
    path = CANOPY_HEIGHT / (slope * d[0] - d[2])
    exact = (1 - ALPHA / 255) ** (path / VOXEL)
    found = trace(ask, technique, (0.0, 3.0, abs(slope) * HALF + CANOPY_HEIGHT), d, worlds.uniform(ALPHA), plane(slope))
    return abs(float(found[:, 0].mean()) - exact)
