"""Layers of point numbers, packed: which texels see a point, and the steps from each number to the next.

A ray's neighbour mostly sees a neighbouring point, so steps are small; they are laid byte by byte, the low ones first,
and what repeats is found by Zstandard.
"""

from __future__ import annotations

import imagecodecs
import numpy as np

from renderer.directional.casting import NONE

LEVEL = 3
"""Of Zstandard: higher ones take several times as long for a few per cent."""


def packed(numbers: np.ndarray) -> bytes:
    """A layer's bytes.

    Args:
        numbers: (d * d,) uint32, `NONE` where nothing is seen.
    """
    seen = numbers != NONE
    steps = np.diff(numbers[seen].astype(np.int64), prepend=0)
    folded = ((steps << 1) ^ (steps >> 63)).astype("<u4")
    planes = folded.view(np.uint8).reshape(-1, 4).T
    return bytes(imagecodecs.zstd_encode(np.packbits(seen).tobytes() + planes.tobytes(), level=LEVEL))


def unpacked(data: bytes | np.ndarray, count: int) -> np.ndarray:
    """The layer (count,) uint32 of `packed` bytes."""
    plain = np.frombuffer(imagecodecs.zstd_decode(bytes(data)), np.uint8)
    mask = -(-count // 8)
    seen = np.unpackbits(plain[:mask], count=count).astype(bool)
    folded = np.ascontiguousarray(plain[mask:].reshape(4, -1).T).view("<u4")[:, 0].astype(np.int64)
    numbers = np.full(count, NONE, np.uint32)
    numbers[seen] = np.cumsum((folded >> 1) ^ -(folded & 1))
    return numbers
