"""Coarser levels of the pattern, in which opacity composes along an axis and is averaged across it."""

from __future__ import annotations

import numpy as np

LEVELS = 5
"""Coarser levels made, each of half the resolution along all three axes."""


def _pairs(a: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
    index = [slice(None)] * a.ndim
    index[axis] = slice(0, None, 2)
    first = a[tuple(index)]
    index[axis] = slice(1, None, 2)
    return first, a[tuple(index)]


def _average(a: np.ndarray, axes: tuple[int, ...]) -> np.ndarray:
    for axis in axes:
        first, second = _pairs(a, axis)
        a = (first + second) / np.float32(2)
    return a


def _compose(colour: np.ndarray, axis: int) -> np.ndarray:
    """Two voxels behind one another along `axis`, associated colours (.., 4), seen from either end alike."""
    first, second = _pairs(colour, axis)
    through = (1 - first[..., 3:]), (1 - second[..., 3:])
    light = (first[..., :3] * (1 + through[1]) + second[..., :3] * (1 + through[0])) / np.float32(2)
    return np.concatenate([light, 1 - through[0] * through[1]], axis=-1)


def coarser(colour: np.ndarray, normal: np.ndarray, anchor: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The next level of a pattern.

    Args:
        colour: float32 (K, J, I, 4), associated albedo and the opacity over one voxel's length, in [0, 1].
        normal: float32 (K, J, I, 4), mean normals and the sky's share. anchor: uint8 (K, J, I, 4).

    Returns:
        The same at half the resolution. Opacity is meant for twice the length. Normals are averaged by opacity, and
        shorten where they disagree; feet and the wood mark are those of the densest child, offsets unchanged; the safe
        distance is the children's least, halved.

    Source: formulas b3 (directional opacity), averaged over the three axes.
    """
    levels = [
        _average(_compose(colour, axis), tuple(other for other in range(3) if other != axis)) for axis in range(3)
    ]
    merged = (levels[0] + levels[1] + levels[2]) / np.float32(3)
    weight = colour[..., 3:] + np.float32(1e-4)
    mean = _average(normal * weight, (0, 1, 2)) / _average(weight, (0, 1, 2))
    return merged, mean.astype(np.float32), _densest(anchor, colour[..., 3])


def coarser_opacity(alpha: np.ndarray) -> np.ndarray:
    """Opacity (K, J, I) uint8 of the next level, as `coarser` has it."""
    given = alpha[..., None].astype(np.float32) / np.float32(255)
    sums = []
    for axis in range(3):
        first, second = _pairs(given, axis)
        sums.append(_average(1 - (1 - first) * (1 - second), tuple(other for other in range(3) if other != axis)))
    return encode_colour((sums[0] + sums[1] + sums[2]) / np.float32(3))[..., 0]


def _densest(anchor: np.ndarray, opacity: np.ndarray) -> np.ndarray:
    k, j, i = (size // 2 for size in opacity.shape)
    children = anchor.reshape(k, 2, j, 2, i, 2, 4).transpose(0, 2, 4, 1, 3, 5, 6).reshape(k, j, i, 8, 4)
    choice = opacity.reshape(k, 2, j, 2, i, 2).transpose(0, 2, 4, 1, 3, 5).reshape(k, j, i, 8).argmax(axis=-1)
    result: np.ndarray = np.take_along_axis(children, choice[..., None, None], axis=3)[..., 0, :].copy()
    result[..., 2] = children[..., 2].min(axis=-1) // 2
    return result


def decode(pattern: dict[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Colour and normal arrays of a pattern as float32: colours in [0, 1], mean normals in [-1, 1], the sky's share in
    [0, 1]."""
    colour = pattern["colour"].astype(np.float32) / np.float32(255)
    normal = pattern["normal"].astype(np.float32) / np.float32(255)
    normal[..., :3] = normal[..., :3] * 2 - 1
    return colour, normal


def encode_colour(colour: np.ndarray) -> np.ndarray:
    """Associated colour and opacity in bytes."""
    return np.round(np.clip(colour, 0, 1) * 255).astype(np.uint8)


def encode_normal(normal: np.ndarray) -> np.ndarray:
    """Mean normals and the sky's share in bytes."""
    shifted = np.concatenate([normal[..., :3] * 0.5 + 0.5, normal[..., 3:]], axis=-1)
    return np.round(np.clip(shifted, 0, 1) * 255).astype(np.uint8)


def mips(pattern: dict[str, np.ndarray]) -> list[dict[str, np.ndarray]]:
    """Levels 1 to LEVELS of a pattern (`colour`, `normal`, `anchor` of level 0), as bytes."""
    colour, normal = decode(pattern)
    anchor = pattern["anchor"]
    levels = []
    for _ in range(LEVELS):
        colour, normal, anchor = coarser(colour, normal, anchor)
        levels.append({"colour": encode_colour(colour), "normal": encode_normal(normal), "anchor": anchor})
    return levels
