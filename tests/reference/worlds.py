"""Forests simple enough to work out by hand, and rays to look at them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.reference.forest_world import ForestWorld

E_SUN = (3.0, 2.0, 1.0)
GROUND = (0.3, 0.2, 0.1)
CENTRE = np.array([[0.5, 0.5]])
UP = np.array([128, 128, 255])
"""A normal that points up, as 8 bits hold it: half a step off."""


def unit(vector: Any) -> np.ndarray:
    """The vector at length one."""
    array = np.asarray(vector, float)
    return array / np.linalg.norm(array)


def sun(azimuth: float, elevation: float) -> tuple[float, float, float]:
    """Unit vector to a sun, from degrees."""
    a, e = np.radians(azimuth), np.radians(elevation)
    return (float(np.sin(a) * np.cos(e)), float(np.cos(a) * np.cos(e)), float(np.sin(e)))


def flat(
    alpha: int | np.ndarray = 0, ambient: int = 0, albedo: float = 0.5, nodes: int = 33, **changes: Any
) -> ForestWorld:
    """A level square under a canopy of one opacity (or one given per voxel), under the zenith sun and no sky."""
    opacity = np.broadcast_to(np.asarray(alpha, np.uint8), (32, 64, 64)) if np.ndim(alpha) == 0 else np.asarray(alpha)
    colour = np.empty((*opacity.shape, 4), np.uint8)
    colour[..., 3] = opacity
    colour[..., :3] = np.round(opacity[..., None] * albedo)
    normal = np.empty_like(colour)
    normal[...] = (*UP, ambient)
    # every tree of the middle rank: it stands where the cover exceeds one half
    anchor = np.full_like(colour, 128)
    anchor[..., 3] = 64
    given: dict[str, Any] = {
        "elevation": np.zeros((nodes, nodes)), "cover": np.ones((nodes, nodes)), "cell": 8.0, "canopy_height": 20.0,
        "tile_side": 40.0, "voxel": 0.625, "colour": colour, "normal": normal, "anchor": anchor,
        "tile": np.zeros((2, 2, 8, 2), np.uint8), "seed": 7, "tint_strength": 0.0, "ground_albedo": GROUND,
        "e_sun": E_SUN, "e_sky": (0.0, 0.0, 0.0), "sun": (0.0, 0.0, 1.0)}
    given.update(changes)
    return ForestWorld(**given)


def looking(points: Any, direction: Any = (0, 0, -1)) -> Callable[[tuple[float, float]], tuple[np.ndarray, np.ndarray]]:
    """Parallel rays, one a pixel of a single row, that meet the level ground z = 0 at the given points."""
    d = unit(direction)
    p = np.atleast_2d(np.asarray(points, float))
    origins = np.concatenate([p, np.zeros((len(p), 1))], axis=1) - d * (60.0 / -d[2])
    return lambda offset: (origins[None], np.broadcast_to(d, (1, len(p), 3)))


def grove(seed: int = 1, size: int = 128, trees: int = 3, **changes: Any) -> ForestWorld:
    """Round crowns of uneven opacity with their feet stored, on waves of ground, trees missing in the west."""
    rng = np.random.default_rng(seed)
    layers, step, cell = 32, 160.0 / size, size // 4
    alpha = np.zeros((layers, size, size), np.uint8)
    normal = np.zeros((layers, size, size, 4), np.uint8)
    normal[...] = (*UP, 140)
    anchor = np.full((layers, size, size, 4), 128, np.uint8)
    anchor[..., 3] = 64
    height = (np.arange(layers) + 0.5) * 20.0 / layers
    for p, q, _ in np.ndindex(4, 4, trees):
        i0, j0 = ((p, q) + rng.uniform(0.25, 0.7, 2)) * cell
        top, radius = rng.uniform(11, 18), rng.uniform(2.5, 3.5)
        for j in range(int(j0) - 4, int(j0) + 5):
            for i in range(int(i0) - 4, int(i0) + 5):
                u, v = (i + 0.5 - i0) * step, (j + 0.5 - j0) * step
                x, y = u + 0.5 * v, v * np.sqrt(0.75)
                out = np.stack([np.full(layers, x), np.full(layers, y), height - 0.6 * top], axis=1)
                out /= (radius, radius, 0.4 * top)
                inside = (out**2).sum(axis=1) < 1
                length = np.linalg.norm(out[inside], axis=1, keepdims=True) + 1e-9
                alpha[inside, j % size, i % size] = rng.integers(20, 240, inside.sum())
                normal[inside, j % size, i % size, :3] = out[inside] / length * 127 + 128
                anchor[inside, j % size, i % size, :2] = np.round([128 - 16 * x, 128 - 16 * y])
    nodes = 33
    east = np.arange(nodes) - 16.0
    ground = 6 * np.sin(east / 3)[None] * np.cos(east / 4)[:, None] + 6
    cover = np.repeat(np.clip(0.5 + (east[None] + 8) / 4, 0, 1), nodes, axis=0)
    given: dict[str, Any] = {
        "nodes": nodes, "normal": normal, "anchor": anchor, "elevation": ground, "cover": cover,
        "tint_strength": 0.2, "tile": rng.integers(0, 4, (2, 2, 8, 2)).astype(np.uint8),
        "e_sky": (0.5, 0.6, 0.8), "sun": sun(130, 35)}
    given.update(changes)
    return flat(alpha, **given)
