"""The exact kernel between two level planes, by one convolution a half-bounce."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar, Literal

from renderer.clouds.radiosity.flat import bounce_maps
from renderer.clouds.radiosity.kernel import flat_exchange
from renderer.clouds.radiosity.maps import BounceMaps
from renderer.clouds.radiosity.technique import BasisTechnique, BounceTechnique, Solved
from renderer.core.params import param
from renderer.core.technique import Arrays


class Fft(BounceTechnique):
    """Exact over level ground, whatever the clouds; blind to relief."""

    title: ClassVar[str] = "Exact kernel"
    caption: ClassVar[str] = "The exact exchange of two level planes as a convolution: no levels, no cut, no relief."
    paper: ClassVar[str] = "Sillion & Puech 1989; convolution by the fast Fourier transform, Cooley & Tukey 1965"

    kind: Literal["fft"] = "fft"
    bounces: int = param(
        4,
        label="Bounces",
        help="From the ground to the clouds and back.",
        unit="count",
        cost="host",
        ge=1,
        le=32,
        source="Belcour 2009, section 5.2.1",
    )
    tail: bool = param(
        True,
        label="Closed tail",
        help="Add what later bounces would, as a geometric series.",
        cost="host",
        source="errata 001-10",
    )

    def solve(self, maps: BounceMaps, basis: BasisTechnique | None, baked: Mapping[str, Arrays]) -> Solved:
        """Bounces between planes that go on beyond the square with their means."""
        exchange = flat_exchange(maps.n, maps.cell / maps.height).spread
        return Solved(maps, bounce_maps(exchange, maps, 2 * self.bounces, self.tail))
