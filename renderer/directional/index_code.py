"""Layers of point numbers, packed: which texels see a point, and the steps from each number to the next.

A ray's neighbour mostly sees a neighbouring point, so steps are small; they are laid byte by byte, the low ones first
and none that are all zero, and what repeats is found by Zstandard.
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
    # Whole numbers modulo 2^32: a step back is a large one whose lowest bit is folded to the sign.
    steps = np.diff(numbers[seen], prepend=np.uint32(0))
    back = steps >> np.uint32(31)
    folded = (steps << np.uint32(1)) ^ (np.uint32(0) - back)
    planes = folded.astype("<u4", copy=False).view(np.uint8).reshape(-1, 4).T
    count = next((k for k in (4, 3, 2, 1) if planes[k - 1].any()), 0)
    plain = bytes([count]) + np.packbits(seen).tobytes() + planes[:count].tobytes()
    return bytes(imagecodecs.zstd_encode(plain, level=LEVEL))


def unpacked(data: bytes | np.ndarray, count: int) -> np.ndarray:
    """The layer (count,) uint32 of `packed` bytes."""
    plain = np.frombuffer(imagecodecs.zstd_decode(bytes(data)), np.uint8)
    mask = -(-count // 8)
    seen = np.unpackbits(plain[1 : mask + 1], count=count).view(bool)
    numbers = np.full(count, NONE, np.uint32)
    most = int(np.count_nonzero(seen))
    folded = np.zeros(most, np.uint32)
    for k in range(int(plain[0])):
        plane = plain[mask + 1 + k * most : mask + 1 + (k + 1) * most]
        folded |= plane.astype(np.uint32) << np.uint32(8 * k)
    steps = (folded >> np.uint32(1)) ^ (np.uint32(0) - (folded & np.uint32(1)))
    numbers[seen] = np.cumsum(steps, dtype=np.uint32)
    return numbers
