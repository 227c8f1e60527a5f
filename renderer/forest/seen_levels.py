"""Coarser levels of the pattern as the eye meets them: matter counts by the light that reaches it from outside.

Averaged as it stands, a stand's matter is too dense: a ray that has come as deep as a voxel came through the gaps,
where there is little. Over a block, transmittance T falls along the ray by mean(sigma T), so that the block's own
extinction is mean(sigma T) / mean(T). Levels halve the sides of a block and keep its height, or the canopy would lose
its layers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from renderer.forest.pattern_mips import LEVELS
from renderer.forest.seen_kernels import follow_light

ELEVATIONS = np.radians([20.0, 40.0, 65.0])
"""Of the rays that count. Between them a level's extinction changes by a tenth, and to the zenith by a quarter."""

AZIMUTHS = 4
"""Of the rays, equally spaced."""

DARK = np.float32(1e-3)
"""Light that every voxel gets on top: where next to none comes down, matter counts as it stands."""

CARRIED = 2
"""Voxels of air beside matter that have its albedo: light is interpolated once on its way in, and once back."""

OPAQUE = np.float32(1 - 2**-12)
"""Opacity at which extinction is cut off."""


def blocks(a: np.ndarray) -> np.ndarray:
    """Four children of every voxel of the next level, (K, J/2, I/2, 4, ...), from (K, J, I, ...)."""
    k, j, i, *rest = a.shape
    moved = np.moveaxis(a.reshape(k, j // 2, 2, i // 2, 2, *rest), 3, 2)
    return moved.reshape(k, j // 2, i // 2, 4, *rest)


def seen_levels(
    level: Mapping[str, np.ndarray], axes: np.ndarray, layer: float, progress: Callable[[float], None]
) -> dict[str, np.ndarray]:
    """Levels 1 to LEVELS of what a view ray reads.

    Args:
        level: `colour` and `anchor` of the finest level, uint8 (K, J, I, 4).
        axes: (2, 2) sides of a voxel [m] along i and j. layer: thickness [m]. progress: told the share done.

    Returns:
        `seen_1` to `seen_5` uint8 (K, J / 2^n, I / 2^n, 8): albedo as it is, opacity for one voxel of the FINEST level,
        and the anchor of the child that shows most, with the children's least safe distance.
    """
    opacity = np.minimum(level["colour"][..., 3].astype(np.float32) / np.float32(255), OPAQUE)
    light, shown = _light(opacity, axes, layer, progress)
    sine = np.sin(ELEVATIONS).astype(np.float32)[:, None, None, None]
    albedo = _albedo(level["colour"])
    anchor, made, rng = level["anchor"], {}, np.random.default_rng(1)
    for number in range(1, LEVELS + 1):
        weights = blocks(shown.mean(axis=0))
        anchor = _anchors(blocks(anchor), weights)
        share = weights / np.maximum(weights.sum(axis=-1, keepdims=True), np.float32(1e-12))
        albedo = (blocks(albedo) * share[..., None]).sum(axis=3)
        light, shown = (np.stack([blocks(one).mean(axis=-1) for one in each]) for each in (light, shown))
        hidden = -np.expm1(-shown / light * sine).mean(axis=0)
        # Rounded up as often as its remainder says: the least of these opacities still adds up over a long ray.
        hidden = np.floor(hidden * 255 + rng.random(hidden.shape)).astype(np.uint8)
        colour = np.rint(np.clip(albedo, 0, 1) * 255).astype(np.uint8)
        made[f"seen_{number}"] = np.concatenate([colour, hidden[..., None], anchor], axis=-1)
    return made


def _albedo(colour: np.ndarray) -> np.ndarray:
    """Albedo (K, J, I, 3); air beside matter has the matter's, which reaches into it between voxels and shows there."""
    total = colour.astype(np.float32)
    for _ in range(CARRIED):
        near = total
        for axis in (1, 2):
            near = near + np.roll(near, 1, axis) + np.roll(near, -1, axis)
        total = np.where(total[..., 3:] > 0, total, near)
    result: np.ndarray = total[..., :3] / np.maximum(total[..., 3:], np.float32(1e-12))
    return result


def _light(
    opacity: np.ndarray, axes: np.ndarray, layer: float, progress: Callable[[float], None]
) -> tuple[np.ndarray, np.ndarray]:
    """By elevation, mean transmittance from outside in each voxel and what the voxel stops on the way through its
    layer, both (E, K, J, I)."""
    extinction = -np.log1p(-opacity) / np.float32(layer)
    light, shown = (np.zeros((len(ELEVATIONS), *opacity.shape), np.float32) for _ in range(2))
    for number, elevation in enumerate(ELEVATIONS):
        path = layer / np.sin(elevation)
        for turn in range(AZIMUTHS):
            azimuth = 2 * np.pi * turn / AZIMUTHS
            ray = np.array([np.sin(azimuth), np.cos(azimuth)]) * np.cos(elevation)
            shift = ray * path @ np.linalg.inv(axes)
            parts = max(2, int(np.ceil(np.abs(shift).max())))
            follow_light(extinction, shift, path, parts, light[number], shown[number])
            progress((number * AZIMUTHS + turn + 1) / (len(ELEVATIONS) * AZIMUTHS))
        light[number] /= AZIMUTHS
        shown[number] /= AZIMUTHS
        # Where next to no light comes, matter counts as it stands.
        light[number] += DARK
        shown[number] += DARK * extinction * np.float32(path)
    return light, shown


def _anchors(anchors: np.ndarray, weights: np.ndarray) -> np.ndarray:
    best = weights.argmax(axis=-1)[..., None, None]
    result: np.ndarray = np.take_along_axis(anchors, best, axis=3)[..., 0, :].copy()
    result[..., 2] = anchors[..., 2].min(axis=3)
    return result
