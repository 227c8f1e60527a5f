"""Fur: curved strands with thin, semi-transparent tips, in any state of growth.

After Perlin and Hoffert 1989, section 5.1 (hair whose density is read where the strand meets the skin); here each
strand is an own curve, the nearest of which a voxel belongs to, so that growth and density are thresholds on two
numbers kept for each voxel: figures 6.1 and 6.6 of Dufort 2005.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.source import Procedure, generator, unit, with_glow, wrapped

SHORTEST = 0.55
"""Length of the shortest strand, as a share of the shell's thickness."""


class Fur(Procedure):
    """Hair that grows."""

    kind: Literal["fur"] = "fur"
    seed: int = param(1, label="Seed", help="Of the strands' places.", cost="bake", ge=0, le=2**31 - 1)
    strands: int = param(
        26, label="Strands", help="Along each side of the repeated square.", unit="count", cost="bake", ge=2, le=128
    )
    width: float = param(
        0.7, label="Width", help="Of a strand at its root, against the strands' distance.", unit="ratio",
        cost="bake", ge=0.1, le=1.5, step=0.05,
    )
    lean: float = param(
        0.3, label="Lean", help="How far a tip hangs over its root, against the thickness.", unit="ratio",
        cost="bake", ge=0, le=1.5, step=0.05,
    )
    curl: float = param(
        0.06, label="Curl", help="Radius of the strands' turns, against the thickness.", unit="ratio",
        cost="bake", ge=0, le=0.5, step=0.01,
    )
    opacity: float = param(
        0.9, label="Opacity", help="Of a voxel inside a strand, behind its tip.", unit="ratio", cost="bake", ge=0, le=1
    )
    root: Colour = param((0.16, 0.075, 0.03), label="Root", help="Colour at the skin.", cost="bake")
    tip: Colour = param((0.78, 0.55, 0.28), label="Tip", help="Colour at the tips.", cost="bake")
    growth: float = param(
        1.0, label="Growth", help="How long the hair is, as a share of its full length.", unit="ratio", cost="host",
        ge=0, le=1, step=0.01, plays=0.2, source="Dufort 2005, figure 6.6",
    )
    density: float = param(
        1.0, label="Density", help="Share of the strands that are there.", unit="ratio", cost="host",
        ge=0, le=1, step=0.01, source="Dufort 2005, figure 6.6",
    )

    def matter(self) -> Matter:
        """Strands, with the growth that reaches each voxel (`birth`) and the density from which it is there."""
        rng = generator(self.seed)
        places = (np.stack(np.meshgrid(*[np.arange(self.strands)] * 2), axis=-1).reshape(-1, 2)
                  + 0.5 + rng.uniform(-0.45, 0.45, (self.strands**2, 2))) * self.side / self.strands
        count = len(places)
        length = rng.uniform(SHORTEST, 1.0, count)
        swing, phase = rng.normal(0.35, 0.5, count), rng.uniform(0, 2 * np.pi, count)
        shade, rank = rng.uniform(0.75, 1.2, count), rng.permutation(count) / count
        radius = 0.5 * self.width * self.side / self.strands
        columns = np.stack(np.broadcast_arrays(*self.centres()[:2]), axis=-1)[0].reshape(-1, 2).astype(np.float64)
        colour, normal = np.empty((*self.shape, 4), np.float32), np.empty((*self.shape, 3), np.float32)
        birth, ranks = np.empty(self.shape, np.float32), np.empty(self.shape, np.float32)
        for layer, height in enumerate(self.centres()[2].ravel().astype(float)):
            along = height / length
            bend = self.lean * along**2
            turn = phase + 5.0 * along
            axis = places + np.stack([bend * np.cos(swing) + self.curl * (np.cos(turn) - np.cos(phase)) * along,
                                      bend * np.sin(swing) + self.curl * (np.sin(turn) - np.sin(phase)) * along], 1)
            distance, nearest = cKDTree(axis % self.side, boxsize=self.side).query(columns)
            away = wrapped(columns - axis[nearest], self.side)
            here = np.minimum(along[nearest], 1.0)
            cover = self.covered(distance - radius * (1.0 - 0.75 * here)) * (along[nearest] < 1.0)
            tint = np.asarray(self.root) + (np.asarray(self.tip) - self.root) * here[:, None]
            square = (self.across, self.across)
            colour[layer, ..., :3] = np.clip(tint * shade[nearest, None], 0.0, 1.0).reshape(*square, 3)
            colour[layer, ..., 3] = (self.opacity * cover).reshape(square)
            raised = np.concatenate([away, np.full((len(away), 1), 0.35 * radius)], axis=1)
            normal[layer] = unit(raised).reshape(*square, 3)
            birth[layer], ranks[layer] = along[nearest].reshape(square), rank[nearest].reshape(square)
        material = (colour[..., 3] > 0).astype(np.uint8)
        return Matter(colour, with_glow(normal), material, birth, ranks)
