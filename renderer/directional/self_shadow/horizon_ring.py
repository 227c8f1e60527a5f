"""A ring of horizons instead of a hemisphere."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.directional.self_shadowing import SelfShadowTechnique


class HorizonRing(SelfShadowTechnique):
    """For each azimuth the height from which on light arrives: exact for land, blind for what hangs over a point."""

    title: ClassVar[str] = "Horizon ring"
    caption: ClassVar[str] = "Each point keeps its horizon by azimuth: exact for land, too dark under overhangs."
    paper: ClassVar[str] = "Max 1988, Horizon mapping; erratum 003-5"

    includes: ClassVar[tuple[str, ...]] = (*SelfShadowTechnique.includes, "directional/shadow_ring.glsl")

    kind: Literal["horizon_ring"] = "horizon_ring"
    size: Literal[5, 9, 17] = param(
        9, label="Bytes", help="Of a point: 8, 16 or 32 azimuths.", unit="count", cost="build"
    )
