"""Precomputed transfer matrices over relief."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from renderer.clouds.bakes import land_bake
from renderer.clouds.first_light import bake_bounce_ground, reach
from renderer.clouds.radiosity.bases import GRID, Basis, haar_basis
from renderer.clouds.radiosity.flat import first
from renderer.clouds.radiosity.kernel import flat_exchange
from renderer.clouds.radiosity.maps import Bounced, BounceMaps
from renderer.clouds.radiosity.matrices import bake_transfer, basis_of
from renderer.clouds.radiosity.relief import RAYS
from renderer.clouds.radiosity.solve import Answers, by_bounces, direct, times
from renderer.clouds.radiosity.technique import BasisTechnique, BounceTechnique, InBasis, Solved
from renderer.clouds.radiosity.transfer import Transfer
from renderer.core.params import param
from renderer.core.technique import Arrays, Bake


class TransferMatrices(BounceTechnique):
    """Matrices G, C and S of a square, baked once for its relief; a moved sun or cloud only solves again."""

    title: ClassVar[str] = "Transfer matrices"
    caption: ClassVar[str] = "Light between ground and clouds by matrices baked over the relief: slopes see each other."
    paper: ClassVar[str] = "Belcour 2009, section 5.2; Sloan, Kautz & Snyder 2002"

    kind: Literal["transfer"] = "transfer"
    coefficients: Literal[15, 64, 256] = param(
        64,
        label="Coefficients",
        help="Functions that describe the light of either side.",
        cost="bake",
        source="Belcour 2009, annex A.2",
    )
    method: Literal["direct", "bounces"] = param(
        "direct",
        label="Solution",
        help="All bounces by one linear system, or a fixed number of them.",
        cost="host",
        source="errata 001-10",
    )
    bounces: int = param(
        4,
        label="Bounces",
        help="From the ground to the clouds and back, where they are counted.",
        unit="count",
        cost="host",
        ge=1,
        le=32,
        source="Belcour 2009, section 5.2.1",
    )
    gather: bool = param(
        True,
        label="Final gather",
        help="Let each place gather the light of the basis by the exact kernel of level "
        "planes, and leave to the basis what relief changes of it: no blocks are seen.",
        cost="host",
    )

    def bakes(self, state: Any) -> list[Bake]:
        """The matrices of the state's basis over its land; level land has none of its own."""
        ground, scale = None, reach(state) / state.layer.base
        if state.land.kind != "flat" and scale == 1:
            named = {name: getattr(state.planet, name) for name in ("albedo", "snow_albedo", "snow_line")}
            arguments = {"height": state.layer.base, **named}
            ground = Bake("bounce_ground", bake_bounce_ground, arguments, (land_bake(state),), seconds=1)
        return [self.matrix_bake(state.basis, state.layer.base, ground, scale)]

    def matrix_bake(self, basis: Any, height: float, ground: Bake | None = None, scale: float = 1.0) -> Bake:
        """The bake `transfer`.

        Args:
            basis: the technique of the slot `basis`. height: of the cloud base, m.
            ground: bake of `elevation` and `albedo` over the square, whose name is `bounce_ground`; none if level.
            scale: of the square against that of side 32H, which is taken for level where it is wider.
        """
        arguments = {
            "basis": basis.kind,
            "coefficients": self.coefficients,
            "height": float(height) if ground is not None else 1.0,
            "scale": float(scale),
            "rays": RAYS,
            "centre_height": float(getattr(basis, "centre_height", 8.0)),
        }
        return Bake("transfer", bake_transfer, arguments, () if ground is None else (ground,), version=2, seconds=12)

    def solve(self, maps: BounceMaps, basis: BasisTechnique | None, baked: Mapping[str, Arrays]) -> Solved:
        """Solve with the baked matrices."""
        if basis is None:
            raise ValueError("transfer matrices need a basis")
        below, above = bases(basis, self.coefficients, baked["transfer"])
        transfer = Transfer.of(baked["transfer"])
        albedo, reflectance = first(maps.albedo), first(maps.reflectances)
        leaving = tuple(first(field) for field in maps.leaving())
        lit = (below.analyse(leaving[0]).astype(np.float32), above.analyse(leaving[1]).astype(np.float32))
        answers = Answers.of(below, above, albedo, reflectance)
        ground, cloud = (
            direct(transfer, answers, *lit)
            if self.method == "direct"
            else by_bounces(transfer, answers, *lit, 2 * self.bounces, tail=True)
        )
        even = Bounced(0 * maps.ground, 0 * maps.ground)
        if self.gather:
            change = baked["transfer"]
            from_ground = lit[0] + times(answers.ground, ground)
            from_cloud = lit[1] + times(answers.cloud, cloud)
            exchange = flat_exchange(GRID, maps.cell / maps.height).spread
            smooth_ground = exchange(leaving[1] + reflectance * _field(above, cloud))
            cloud = times(change["relief_from_ground"], from_ground)
            ground = times(change["relief_from_cloud"], from_cloud) + times(transfer.on_ground, from_ground)
            smooth_cloud = exchange(leaving[0] + albedo * (smooth_ground + _field(below, ground)))
            smooth_ground = exchange(leaving[1] + reflectance * (smooth_cloud + _field(above, cloud)))
            even = Bounced(np.moveaxis(smooth_ground, 0, -1), np.moveaxis(smooth_cloud, 0, -1))
        return Solved(maps, even, InBasis(below, ground.astype(np.float32)), InBasis(above, cloud.astype(np.float32)))


def _field(basis: Basis, coefficients: np.ndarray) -> np.ndarray:
    return basis.synthesise(coefficients).astype(np.float32)


def bases(technique: BasisTechnique, coefficients: int, matrices: Arrays) -> tuple[Basis, Basis]:
    """Ground's and cloud's basis, as the matrices were baked."""
    if technique.kind == "haar":  # type: ignore[attr-defined]
        return haar_basis(matrices["ground_kept"]), haar_basis(matrices["cloud_kept"])
    both = basis_of(technique.kind, coefficients, getattr(technique, "centre_height", 8.0))  # type: ignore[attr-defined]
    return both, both
