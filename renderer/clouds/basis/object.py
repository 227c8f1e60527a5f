"""Blocks of equal size, each its own function."""

from __future__ import annotations

from typing import ClassVar, Literal

import numpy as np

from renderer.clouds.radiosity.bases import Basis, object_basis
from renderer.clouds.radiosity.technique import BasisTechnique, InBasis, Solved


class ObjectBasis(BasisTechnique):
    """Indicator functions of blocks: products by the reflectance are products of coefficients."""

    title: ClassVar[str] = "Blocks"
    caption: ClassVar[str] = "Equal blocks, one number each: as good as its blocks are small against the mountains."
    paper: ClassVar[str] = "Belcour 2009, section 5.2.2 (object basis)"

    kind: Literal["object"] = "object"

    def chosen(self, coefficients: int, estimate: np.ndarray) -> Basis:
        """The same blocks whatever the light."""
        return object_basis(coefficients)

    def pictures(self, solved: Solved) -> dict[str, np.ndarray]:
        """`ground_map` and `cloud_map`: a texel a block, (rows, columns, C)."""
        return {"ground_map": _blocks(solved.ground), "cloud_map": _blocks(solved.cloud)}


def _blocks(side: InBasis | None) -> np.ndarray:
    if side is None:
        return np.zeros((1, 1, 3), np.float32)
    count = side.basis.n
    rows = int(np.sqrt(count))
    return np.moveaxis(side.coefficients.reshape(-1, rows, count // rows), 0, -1).astype(np.float32)
