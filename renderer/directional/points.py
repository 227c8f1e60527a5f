"""The points of the cloud as the GPU holds them: 16 bytes each, and their shadow codes beside."""

from __future__ import annotations

import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.cloud import rounded_positions
from renderer.directional.frames import encoded
from renderer.world.image import srgb_encode

ROW = 2048
"""Points a row of texels: `SURFEL_ROW` in shaders/directional/surfel.glsl."""

WIDEST = 16384
"""Texels of a row that every OpenGL has: as many points of a code as fit, `CODE_ROW` there."""


def surfel_texels(cloud: Arrays, used: np.ndarray, openness: np.ndarray, box: np.ndarray, bits: int) -> np.ndarray:
    """(rows, `ROW`, 4) uint32 as `shaders/directional/surfel.glsl` reads them.

    Args:
        cloud: `position` (N, 3) [m], `normal` (N, 3), `colour` (N, 3) linear reflectance.
        used: (M,) the points that any face sees. openness: (M,) in [0, 1].
        box: (2, 3), lowest and highest corner [m]. bits: of a coordinate that are used.
    """
    share = (rounded_positions(cloud["position"][used], box, bits) - box[0]) / (box[1] - box[0])
    place = np.rint(np.clip(share, 0, 1) * 65535).astype(np.uint32)
    code = np.rint(srgb_encode(np.clip(cloud["colour"][used].astype(np.float64), 0, 1)) * 255).astype(np.uint32)
    open_code = np.rint(np.clip(openness, 0, 1) * 255).astype(np.uint32)
    words = np.stack(
        [
            place[:, 0] | place[:, 1] << np.uint32(16),
            place[:, 2] | open_code << np.uint32(16),
            encoded(cloud["normal"][used].astype(np.float64)),
            code[:, 0] | code[:, 1] << np.uint32(8) | code[:, 2] << np.uint32(16),
        ],
        axis=-1,
    )
    return rows_of(words, 1)


def code_texels(words: np.ndarray) -> np.ndarray:
    """(rows, points a row * blocks, 4) uint32 of shadow codes (M, W): each point's words in `blocks` texels."""
    blocks = -(-max(words.shape[1], 1) // 4)
    filled = np.zeros((len(words), 4 * blocks), np.uint32)
    filled[:, : words.shape[1]] = words
    return rows_of(filled.reshape(len(words), blocks, 4).reshape(-1, 4), blocks)


def rows_of(texels: np.ndarray, blocks: int) -> np.ndarray:
    """Texels (M * blocks, 4) in rows of `ROW` points or as many as fit, the last one filled up with zeros."""
    across = min(ROW, WIDEST // blocks) * blocks
    rows = -(-max(len(texels), 1) // across)
    padded = np.zeros((rows * across, 4), np.uint32)
    padded[: len(texels)] = texels
    return padded.reshape(rows, across, 4)
