"""Wicker: rods over and under one another, figure 6.3 of Dufort 2005."""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.noise import noise
from renderer.shells.texture.source import Procedure, generator, slope_of, unit, with_glow, wrapped

MIDDLE = 0.4
"""Height about which the rods go up and down."""


class Weave(Procedure):
    """Wicker."""

    kind: Literal["weave"] = "weave"
    across: int = param(
        64, label="Voxels across", help="Along each side of the repeated square.", unit="voxel", cost="bake",
        ge=8, le=512, source="Dufort 2005, table 6.1",
    )
    seed: int = param(7, label="Seed", help="Of the rods' shades.", cost="bake", ge=0, le=2**31 - 1)
    pairs: int = param(
        2, label="Pairs of rods", help="Along each side of the repeated square.", unit="count", cost="bake", ge=1, le=16
    )
    width: float = param(
        0.74, label="Width", help="Of a rod, against the rods' distance.", unit="ratio", cost="bake", ge=0.2, le=1,
        step=0.02,
    )
    rod: Colour = param((0.5, 0.31, 0.14), label="Colour", help="Mean reflectance of the rods.", cost="bake")

    def matter(self) -> Matter:
        """Opaque rods, nothing between them."""
        rng = generator(self.seed)
        x, y, z = self.centres()
        rods = 2 * self.pairs
        pitch = self.side / rods
        along = self._rod(y, x, z, pitch, 1.0)
        across = self._rod(x, y, z, pitch, -1.0)
        shade = rng.uniform(0.75, 1.25, (2, rods))
        number = [np.floor(place / pitch).astype(int) for place in (y, x)]
        fibres = [noise(rng, x, y, z, self.side, 3 * rods, 2, (8.0 / 3.0, 2.0)),
                  noise(rng, y, x, z, self.side, 3 * rods, 2, (8.0 / 3.0, 2.0))]
        tones = [shade[n][np.broadcast_to(number[n], self.shape)] * (1.0 + 0.35 * fibres[n]) for n in range(2)]
        tone = np.where(along < across, tones[0], tones[1])
        distance = np.minimum(along, across).astype(np.float32)
        cover = self.covered(distance)
        colour = np.empty((*self.shape, 4), np.float32)
        colour[..., :3] = np.clip(np.asarray(self.rod) * tone[..., None], 0.0, 1.0)
        colour[..., 3] = cover
        return Matter(colour, with_glow(unit(slope_of(distance))), (cover > 0).astype(np.uint8))

    def _rod(self, side: np.ndarray, along: np.ndarray, z: np.ndarray, pitch: float, first: float) -> np.ndarray:
        """Signed distance (about) to the nearest rod of one direction.

        Args:
            side, along: place across and along the rods. first: 1 or -1, whether the first rod begins above.
        """
        number = np.floor(side / pitch)
        swing = first * np.cos(np.pi * (along / pitch - 0.5 + number))
        thick = 0.15
        wide = 0.5 * self.width * pitch
        off = wrapped(side - (number + 0.5) * pitch, self.side) / wide
        up = (z - MIDDLE - 0.18 * swing) / thick
        # A superellipse, flatter than round: its level set's value over its slope is the distance near the surface.
        power = 2.3
        level = (np.abs(off) ** power + np.abs(up) ** power + 1e-9) ** (1 / power)
        return (level - 1.0) * min(wide, thick)
