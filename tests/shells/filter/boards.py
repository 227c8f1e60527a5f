"""A board of light and dark columns, finer than pixels."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

Draw = Callable[..., np.ndarray]


def board(cells: int = 64, layers: int = 4) -> np.ndarray:
    """Opaque columns, two voxels wide, in turns white and black."""
    block = np.zeros((layers, cells, cells, 4), np.float32)
    block[..., 3] = 0.99
    block[..., :3] = ((np.arange(cells) // 2 % 2)[:, None] ^ (np.arange(cells) // 2 % 2))[None, :, :, None]
    return block


def contrast(draw: Draw, kind: dict[str, Any], block: np.ndarray, size: int = 9) -> float:
    """Standard deviation of a picture whose pixels are as wide as some cells of the board."""
    camera = {"kind": "orthographic", "centre": [0, 0, 0], "direction": [0, 0, -1], "up": [0, 1, 0], "width": 1.9}
    found = draw({"filter": kind, "camera": camera}, block, size=size)
    return float(2 * found[..., 0].std())
