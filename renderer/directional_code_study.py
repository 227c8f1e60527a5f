"""How small other ways to write down what texels see would be: the evidence for the one in use."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from typing import Any

import imagecodecs
import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.casting import NONE, Caster, face_frame, face_middles
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.index_code import LEVEL, packed
from renderer.directional.morton import morton

SIZES = ((128, 513), (128, 2049))
"""Texels and directions."""

FACES = (0, 3, 5)
STEPS = 6
"""Directions of each of these faces, evenly among all, that are looked along with their neighbours."""

TITLES = {
    "numbers": "numbers as they are, byte by byte, Zstandard",
    "steps": "steps along rows, Zstandard: in use",
    "finest": "the same at Zstandard's level 19",
    "zlib": "the same by zlib",
    "columns": "steps from the nearer of left and above",
    "direction": "steps from the same texel in the neighbouring direction",
    "morton": "steps of points numbered along Morton's curve",
    "triangles": "triangles alone: a point would follow from its ray",
}
"""What the codes are, by name."""


def codes(kind: str, caster: Caster, cloud: Arrays) -> list[dict[str, Any]]:
    """Bits a texel of each code, for each of `SIZES`: lines of a table."""
    position = np.asarray(cloud["position"], float)
    place = np.empty(len(position), np.uint32)
    place[np.argsort(morton(position, float(cloud["spacing"])), kind="stable")] = np.arange(len(position))
    triangle = np.asarray(cloud["triangle"], np.uint32)
    lines = []
    for texels, directions in SIZES:
        ways = hemisphere_of(directions).directions()
        total = dict.fromkeys(TITLES, 0)
        looked = 0
        for face in FACES:
            origins, frame = face_middles(caster.box, face, texels), face_frame(face)
            # The first of a pair has its neighbour in azimuth before it.
            for number in np.linspace(1, directions - 2, STEPS).astype(int):
                seen, beside = (caster.points(origins, -(ways[k] @ frame)) for k in (number, number - 1))
                looked += texels**2
                for name, size in _sizes(seen, beside, texels, place, triangle).items():
                    total[name] += size
        lines.append({"part": "codes", "subject": kind, "texels": texels, "directions": directions,
                      **{name: 8 * size / looked for name, size in total.items()}})
    return lines


def _sizes(
    seen: np.ndarray, beside: np.ndarray, texels: int, place: np.ndarray, triangle: np.ndarray
) -> dict[str, int]:
    """Bytes of one layer in each code."""
    there = seen != NONE
    numbers = seen.astype(np.int64)
    mask = np.packbits(there).tobytes()

    def size(steps: np.ndarray, pack: Callable[[bytes], bytes] = lambda plain: _zstd(plain, LEVEL)) -> int:
        folded = ((steps << 1) ^ (steps >> 63)).astype("<u4")
        planes = folded.view(np.uint8).reshape(-1, 4).T
        return len(pack(mask + planes.tobytes()))

    along = np.diff(numbers[there], prepend=0)
    grid = numbers.reshape(texels, texels)
    left, above = np.roll(grid, 1, axis=1), np.roll(grid, 1, axis=0)
    corner = np.roll(left, 1, axis=0)
    # Where the corner is nearer to what stands left, the way up changed less there, and so it does here.
    nearer = np.where(np.abs(left - corner) < np.abs(above - corner), above, left)
    nearer = np.where(nearer == NONE, np.where(left != NONE, left, above), nearer)
    nearer = np.where(nearer == NONE, 0, nearer).reshape(-1)
    before = np.concatenate([[0], numbers[:-1]])
    before = np.where(before == NONE, 0, before)
    other = np.where(beside != NONE, beside.astype(np.int64), before)
    return {
        "numbers": len(_zstd(mask + seen[there].view(np.uint8).reshape(-1, 4).T.tobytes(), LEVEL)),
        "steps": len(packed(seen)),
        "finest": size(along, lambda plain: _zstd(plain, 19)),
        "zlib": size(along, lambda plain: zlib.compress(plain, 6)),
        "columns": size((numbers - nearer)[there]),
        "direction": size((numbers - other)[there]),
        "morton": size(np.diff(place[seen[there]].astype(np.int64), prepend=0)),
        "triangles": size(np.diff(triangle[seen[there]].astype(np.int64), prepend=0)),
    }


def _zstd(plain: bytes, level: int) -> bytes:
    return bytes(imagecodecs.zstd_encode(plain, level=level))


def table(lines: list[dict[str, Any]]) -> list[str]:
    """Rows of the table: a code each."""
    heads = [f"{line['subject']}, {line['texels']} x {line['directions']:,}" for line in lines]
    text = [f"| bits a texel | {' | '.join(heads)} |", "| --- |" + " ---: |" * len(lines)]
    for name, title in TITLES.items():
        text.append(f"| {title} | " + " | ".join(f"{line[name]:.2f}" for line in lines) + " |")
    return text
