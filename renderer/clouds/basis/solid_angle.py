"""Cells of constant solid angle: fine in the middle of the square, coarse at its rim."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.radiosity.bases import GRID, Basis, solid_angle_basis
from renderer.clouds.radiosity.technique import BasisTechnique, InBasis, Solved
from renderer.core.params import param


class SolidAngleBasis(BasisTechnique):
    """Sectors of rings, each of which a point above the middle sees as large as any other."""

    title: ClassVar[str] = "Rings of constant solid angle"
    caption: ClassVar[str] = "Fine in the middle, coarse far out, where an error counts less for what is drawn."
    paper: ClassVar[str] = "Belcour 2009, section 5.2.2 (constant angles, figure 5.10)"
    textures = {**BasisTechnique.textures, "parts": "sampler2D"}

    kind: Literal["solid_angle"] = "solid_angle"
    centre_height: float = param(
        8.0,
        label="Height of the point",
        help="From which the cells look equal, in heights of the cloud base; the "
        "lower, the finer the middle and the coarser the rim.",
        unit="ratio",
        cost="bake",
        ge=1,
        le=64,
        source="Belcour 2009, section 5.2.2",
    )

    def chosen(self, coefficients: int, estimate: np.ndarray) -> Basis:
        """The same cells whatever the light."""
        return solid_angle_basis(coefficients, self.centre_height)

    def pictures(self, solved: Solved) -> dict[str, np.ndarray]:
        """`ground_map` and `cloud_map`: a texel a cell, (1, n, C); `parts`: which cell is where, (GRID, GRID, 1)."""
        labels = np.zeros((GRID, GRID)) if solved.ground is None else solved.ground.basis.labels
        return {
            "ground_map": _row(solved.ground),
            "cloud_map": _row(solved.cloud),
            "parts": labels[..., None].astype(np.float32),
        }


def _row(side: InBasis | None) -> np.ndarray:
    if side is None:
        return np.zeros((1, 1, 3), np.float32)
    return side.coefficients.T[None].astype(np.float32)
