"""Trees on a meadow, with fog between them where wanted: figure 6.4 of Dufort 2005."""

from __future__ import annotations

from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.noise import noise
from renderer.shells.texture.source import Procedure, generator, mixed, slope_of, unit, with_glow, wrapped

TUFTS = 16
"""Balls of leaves in a crown."""


class Trees(Procedure):
    """Trees that stand in the shell."""

    kind: Literal["trees"] = "trees"
    seed: int = param(9, label="Seed", help="Of the trees' places and shapes.", cost="bake", ge=0, le=2**31 - 1)
    trees: int = param(
        3, label="Trees", help="Along each side of the repeated square.", unit="count", cost="bake", ge=1, le=12
    )
    conifers: float = param(
        0.35, label="Conifers", help="Share of trees with needles.", unit="ratio", cost="bake", ge=0, le=1, step=0.05
    )
    fog: float = param(
        0.0, label="Fog", help="Optical depth of the fog between the trees, along the thickness.", cost="bake",
        ge=0, le=8, step=0.1,
    )
    leaves: Colour = param((0.12, 0.26, 0.05), label="Leaves", help="Mean reflectance of the leaves.", cost="bake")
    wood: Colour = param((0.17, 0.11, 0.07), label="Trunks", help="Reflectance of the trunks.", cost="bake")
    meadow: Colour = param((0.2, 0.26, 0.07), label="Meadow", help="Reflectance of the ground.", cost="bake")
    mist: Colour = param((0.82, 0.85, 0.9), label="Fog's colour", help="Reflectance of the fog.", cost="bake")
    second_opacity: float = param(
        1.0, label="Opacity of the fog", help="Factor on the fog's own.", unit="ratio", cost="host", ge=0, le=1,
        source="Dufort 2005, figure 5.13",
    )

    def matter(self) -> Matter:
        """Opaque trees and ground are the first material; the fog is the second and has no normals."""
        rng = generator(self.seed)
        x, y, z = self.centres()
        pitch = self.side / self.trees
        grid = np.stack(np.meshgrid(*[np.arange(self.trees)] * 2), axis=-1).reshape(-1, 2)
        feet = (grid + 0.5 + rng.uniform(-0.25, 0.25, grid.shape)) * pitch
        tall = rng.uniform(0.72, 0.95, len(feet))
        needles = rng.permutation(len(feet)) < round(self.conifers * len(feet))
        wide = np.minimum(0.36 * tall * np.where(needles, 0.75, 1.1), 0.48 * pitch)
        rough = noise(rng, x, y, z, self.side, max(2, self.across // 6), 2)
        crown, own = self._crowns(rng, feet, tall, wide, needles)
        crown = crown + 0.035 * rough
        trunk = self._trunks(feet, tall)
        ground = z - 0.035 - 0.02 * noise(rng, x, y, np.zeros(1), self.side, max(2, self.across // 8), 2)
        distance = np.minimum(np.minimum(crown, trunk), ground).astype(np.float32)
        tone = rng.uniform(0.75, 1.25, len(feet))[own] * (1.0 + 0.5 * rough) * (0.7 + 0.4 * z)
        green = np.where(needles[own][..., None], np.array([0.45, 0.62, 0.75]), 1.0) * self.leaves
        colour = np.where((crown <= trunk)[..., None], green * tone[..., None], np.asarray(self.wood))
        low = (ground < np.minimum(crown, trunk))[..., None]
        colour = np.clip(np.where(low, np.asarray(self.meadow) * (1.0 + 0.4 * rough)[..., None], colour), 0.0, 1.0)
        cover = self.covered(distance)
        # Fog lies: it is half as dense every third of the height.
        lying = np.exp2(-3.0 * z)
        thin = -np.expm1(-self.fog * lying / lying.sum()) * (1.0 - cover)
        normal = unit(slope_of(distance)) * (cover > 0)[..., None]
        material = np.where(cover > 0.05, 1, np.where(thin + cover > 0, 2, 0)).astype(np.uint8)
        return Matter(mixed((cover, colour), (thin, self.mist)), with_glow(normal), material)

    def _crowns(
        self, rng: np.random.Generator, feet: np.ndarray, tall: np.ndarray, wide: np.ndarray, needles: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Signed distance (about) to the leaves, and the number of the tree they belong to, both (K, J, I)."""
        count = len(feet)
        turn, share = rng.uniform(0, 2 * np.pi, (count, TUFTS)), (np.arange(TUFTS) + 0.5) / TUFTS
        out = np.sqrt(rng.uniform(0.1, 1.0, (count, TUFTS)))
        # Needles: tufts on a spiral that narrows upwards. Leaves: tufts all over an egg.
        height = np.where(needles[:, None], 0.2 + 0.76 * share, 0.42 + 0.44 * share)
        reach = np.where(needles[:, None], 0.62 * (1.04 - share), 0.62 * out * np.sin(np.pi * (0.12 + 0.8 * share)))
        turn = np.where(needles[:, None], 2.4 * np.arange(TUFTS), turn)
        radius = np.where(needles[:, None], 0.14 + 0.4 * (1.0 - share), rng.uniform(0.34, 0.5, (count, TUFTS)))
        radius = radius * wide[:, None]
        centre = np.stack([
            feet[:, :1] + wide[:, None] * reach * np.cos(turn),
            feet[:, 1:] + wide[:, None] * reach * np.sin(turn),
            np.minimum(tall[:, None] * height, 0.96 - radius),
        ], axis=-1).reshape(-1, 3)
        radius = radius.reshape(-1)
        centre[:, :2] %= self.side
        box = np.array([self.side, self.side, 0.0])
        few = min(8, len(centre))
        distance, nearest = cKDTree(centre, boxsize=box).query(self.points(), k=np.arange(1, few + 1))
        surface = distance - radius[nearest]
        first = surface.argmin(axis=1)[:, None]
        own = np.take_along_axis(nearest, first, 1) // TUFTS
        return np.take_along_axis(surface, first, 1).reshape(self.shape), own.reshape(self.shape)

    def _trunks(self, feet: np.ndarray, tall: np.ndarray) -> np.ndarray:
        """Signed distance (about) to the trunks, (K, J, I)."""
        x, y, z = self.centres()
        found = np.full(self.shape, np.inf)
        for foot, height in zip(feet, tall):
            off = np.hypot(wrapped(x - foot[0], self.side), wrapped(y - foot[1], self.side))
            thick = 0.05 * height * (1.35 - z / height) + 0.04 * np.exp(-z / 0.05)
            np.minimum(found, np.maximum(off - thick, z - 0.8 * height), out=found)
        return found
