"""Clouds for a planet seen from afar: noise, without a surface."""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.params import param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.noise import noise
from renderer.shells.texture.source import Procedure, generator


class Clouds(Procedure):
    """Clouds."""

    kind: Literal["clouds"] = "clouds"
    seed: int = param(5, label="Seed", help="Of the clouds' places.", cost="bake", ge=0, le=2**31 - 1)
    cells: int = param(
        4, label="Systems", help="Along each side of the repeated square.", unit="count", cost="bake", ge=1, le=32
    )
    cover: float = param(
        0.5, label="Cover", help="Share of the sky with clouds.", unit="ratio", cost="bake", ge=0.05, le=1, step=0.05
    )
    optical_depth: float = param(
        6.0, label="Optical depth", help="Along the thickness, where the clouds are thickest.", cost="bake", ge=0,
        le=30,
    )

    def matter(self) -> Matter:
        """White, flat below and swelling above where the noise is strongest; no normals."""
        rng = generator(self.seed)
        x, y, z = self.centres()
        flat = np.zeros(1)
        octaves = max(2, min(4, int(np.log2(self.across / self.cells)) - 1))
        # Winds bend the clouds: the noise is read where another, wider one has carried it.
        carried = [0.25 * self.side / self.cells * noise(rng, x[0], y[0], flat, self.side, self.cells)
                   for _ in range(2)]
        cloudy = noise(rng, (x[0] + carried[0]) % self.side, (y[0] + carried[1]) % self.side, flat, self.side,
                       self.cells, octaves)
        threshold = float(np.quantile(cloudy, 1.0 - self.cover))
        strength = np.clip((cloudy - threshold) / max(float(cloudy.max()) - threshold, 1e-6), 0.0, 1.0)
        detail = noise(rng, x, y, z, self.side, 3 * self.cells, 3)
        top = 0.12 + 0.8 * np.sqrt(strength) * (1.0 + 0.35 * detail)
        # Thins over a sixth of the shell towards its upper side, and over a twentieth towards its base.
        body = np.clip((top - z) / 0.16, 0.0, 1.0) * np.clip((z - 0.06) / 0.05, 0.0, 1.0)
        edge = np.clip(strength / 0.25, 0.0, 1.0)
        depth = self.optical_depth / self.layers * body * edge * edge * (3.0 - 2.0 * edge)
        colour = np.full((*self.shape, 4), 0.95, np.float32)
        colour[..., 3] = -np.expm1(-depth)
        return Matter(colour, np.zeros_like(colour), np.where(colour[..., 3] > 0, 2, 0).astype(np.uint8))
