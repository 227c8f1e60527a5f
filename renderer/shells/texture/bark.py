"""Bark: plates between long fissures."""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.noise import noise
from renderer.shells.texture.raised import under
from renderer.shells.texture.source import Procedure, generator


class Bark(Procedure):
    """Bark, whose fissures run along v."""

    kind: Literal["bark"] = "bark"
    seed: int = param(6, label="Seed", help="Of the fissures.", cost="bake", ge=0, le=2**31 - 1)
    fissures: int = param(
        8, label="Fissures", help="Along the side of the repeated square that they cross.", unit="count", cost="bake",
        ge=2, le=64,
    )
    bark: Colour = param((0.25, 0.17, 0.11), label="Plates", help="Reflectance of the plates.", cost="bake")
    deep: Colour = param((0.06, 0.035, 0.02), label="Fissures' colour", help="Reflectance in the depth.", cost="bake")

    def matter(self) -> Matter:
        """Opaque down to the base surface."""
        rng = generator(self.seed)
        x, y = self.centres()[0][0], self.centres()[1][0]
        flat = np.zeros(1)
        bend = self.side / self.fissures * noise(rng, x, y, flat, self.side, max(2, self.fissures // 3), 2, (0.6, 1.0))
        ridge = noise(rng, (x + 0.6 * bend) % self.side, y, flat, self.side, self.fissures, 1, (0.25, 1.0))
        cross = noise(rng, x, (y + bend) % self.side, flat, self.side, self.fissures, 1, (0.9, 1.0))
        fine = noise(rng, x, y, flat, self.side, 3 * self.fissures, 2, (0.4, 1.0))
        # Fissures where the noise changes sign; cross-cracks are shallower.
        depth = np.maximum(np.exp(-((ridge / 0.13) ** 2)), 0.55 * np.exp(-((cross / 0.06) ** 2)))
        height = np.clip(0.82 - 0.68 * depth + 0.08 * fine * (1 - depth) + 0.08 * np.abs(ridge), 0.03, 0.97)
        share = np.clip(depth - 0.25 * fine, 0.0, 1.0)[..., None]
        tint = (np.asarray(self.bark) * (1 - share) + np.asarray(self.deep) * share) * (1.0 + 0.45 * fine)[..., None]
        return under(self, height, tint)
