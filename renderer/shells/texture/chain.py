"""Chains side by side: figure 6.1 of Dufort 2005."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.source import Procedure, slope_of, unit, with_glow, wrapped

WIRE = 0.11
"""Radius of the links' wire, where the shell is 1 high."""

BEND = 0.38
"""Radius of the bends, to the middle of the wire."""


class Chain(Procedure):
    """Chains along u."""

    kind: Literal["chain"] = "chain"
    links: int = param(
        2, label="Pairs of links", help="Along the repeated square.", unit="count", cost="bake", ge=1, le=16
    )
    rows: int = param(
        4, label="Chains", help="Side by side in the repeated square.", unit="count", cost="bake", ge=1, le=16
    )
    metal: Colour = param((0.6, 0.58, 0.52), label="Metal", help="Reflectance of the links.", cost="bake")

    def matter(self) -> Matter:
        """Opaque links, turned to one side and the other in turn; nothing between them."""
        x, y, z = self.centres()
        pitch = self.side / (2 * self.links)
        row = self.side / self.rows
        # The wire of one link lies in the bend of the next: twice its radius less than they are long.
        straight = max(pitch / 2 + WIRE - BEND, 0.0)
        off = (y / row - np.floor(y / row) - 0.5) * row
        up = z - 0.5
        tilted = [(off + up) / math.sqrt(2), (off - up) / math.sqrt(2)]
        found = np.full(self.shape, np.inf, np.float32)
        for turn in range(2):
            place = wrapped(x - turn * pitch, 2 * pitch)
            ring = np.hypot(np.maximum(np.abs(place) - straight, 0.0), tilted[turn]) - BEND
            np.minimum(found, np.hypot(ring, tilted[1 - turn]) - WIRE, out=found)
        cover = self.covered(found)
        colour = np.empty((*self.shape, 4), np.float32)
        colour[..., :3] = self.metal
        colour[..., 3] = cover
        return Matter(colour, with_glow(unit(slope_of(found))), (cover > 0).astype(np.uint8))
