"""A small pattern with coarser levels, whose leaves one can put in disorder."""

from __future__ import annotations

from typing import Any

import numpy as np

from renderer.forest.pattern_mips import mips


def blocks(disorder: float) -> dict[str, Any]:
    """A small pattern whose voxels' leaves lie alike, but differently from voxel to voxel."""
    rng = np.random.default_rng(8)
    shape = (8, 16, 16)
    way = rng.normal(size=(*shape, 3)) * disorder + [0.0, 0.3, 1.0]
    way /= np.linalg.norm(way, axis=-1, keepdims=True)
    colour = np.zeros((*shape, 4), np.uint8)
    colour[...] = (40, 60, 20, 90)
    normal = np.concatenate([np.rint(way * 127.5 + 127.5), np.full((*shape, 1), 200)], axis=-1).astype(np.uint8)
    level = {"colour": colour, "normal": normal, "anchor": np.full((*shape, 4), 64, np.uint8)}
    coarse = mips({name: np.tile(a, (4, 2, 2, 1)) for name, a in level.items()})
    return {**{name: np.tile(a, (4, 2, 2, 1)) for name, a in level.items()},
            **{f"{name}_{n}": a for n, given in enumerate(coarse[:2], 1) for name, a in given.items()}}
