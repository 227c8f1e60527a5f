"""The same absorbing matter everywhere: figure 6.1's green absorber."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from renderer.core.params import Colour, param
from renderer.shells.texture.block import Matter
from renderer.shells.texture.source import Procedure


class Uniform(Procedure):
    """The same everywhere."""

    kind: Literal["uniform"] = "uniform"
    across: int = param(
        8, label="Voxels across", help="Along each side of the repeated square.", unit="voxel", cost="bake",
        ge=1, le=512,
    )
    layers: int = param(
        8, label="Voxels high", help="From the base surface to the shell's top.", unit="voxel", cost="bake",
        ge=1, le=64,
    )
    colour: Colour = param((0.05, 0.6, 0.12), label="Colour", help="Of what absorbs.", cost="bake")
    optical_depth: float = param(
        1.5, label="Optical depth", cost="bake", ge=0, le=8,
        help="Of the shell seen along its thickness: exp(-this) of the light passes.",
    )

    def matter(self) -> Matter:
        """An optical depth that is the same for every voxel of height, and no surface."""
        colour = np.empty((*self.shape, 4), np.float32)
        colour[...] = (*self.colour, -math.expm1(-self.optical_depth / self.layers))
        return Matter(colour, np.zeros_like(colour), np.full(self.shape, 2, np.uint8))
