"""Three mip levels of the plane opposite, weighed by their form factors."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import numpy as np

from renderer.clouds.radiosity.flat import bounce_maps, first
from renderer.clouds.radiosity.form_factors import Reading, level_weights
from renderer.clouds.radiosity.levels import ThreeLevelExchange
from renderer.clouds.radiosity.maps import BounceMaps
from renderer.clouds.radiosity.technique import BasisTechnique, BounceTechnique, Solved
from renderer.core.params import param
from renderer.core.technique import Arrays


@functools.lru_cache(maxsize=4)
def three_levels(n: int, cell_over_height: float, reading: Reading) -> ThreeLevelExchange:
    """The exchange of a grid, made once."""
    return ThreeLevelExchange(n, cell_over_height, 1.0, reading)


class ThreeLevel(BounceTechnique):
    """Bouthors' half-bounce: three means of what the other plane sends, whose last sum each pixel makes itself."""

    title: ClassVar[str] = "Three levels"
    caption: ClassVar[str] = "Three mip levels of the plane opposite, by form factors: cheap, rough, level ground only."
    paper: ClassVar[str] = "Bouthors, Neyret & Lefebvre 2006; Belcour 2009, section 5.1"
    extra_declarations: ClassVar[tuple[str, ...]] = (
        *BounceTechnique.extra_declarations,
        "uniform vec3 bounce_weights; // of the means over H, 2H and 8H",
    )

    kind: Literal["three_level"] = "three_level"
    reading: Literal["texels", "taps", "discs"] = param(
        "taps",
        label="Footprints",
        help="What a level's mean is taken over: the texel that holds the point, the reach "
        "of a bilinear tap, or discs.",
        cost="host",
        source="Belcour 2009, section 5.1.2 (formulas a7, errata 001-6)",
    )
    bounces: int = param(
        4,
        label="Bounces",
        help="From the ground to the clouds and back.",
        unit="count",
        cost="host",
        ge=1,
        le=32,
        source="Belcour 2009, section 5.1.1: 2 to 8",
    )
    tail: bool = param(
        True,
        label="Closed tail",
        help="Add what later bounces would, as a geometric series.",
        cost="host",
        source="errata 001-10",
    )

    def solve(self, maps: BounceMaps, basis: BasisTechnique | None, baked: Mapping[str, Arrays]) -> Solved:
        """Bounces, and the means of all that leaves, from which the shader makes the last half-bounce."""
        exchange = three_levels(maps.n, maps.cell / maps.height, self.reading)
        added = bounce_maps(exchange.spread, maps, 2 * self.bounces, self.tail)
        ground, cloud = maps.leaving()
        leaving = ground + maps.albedo * added.ground, cloud + maps.reflectances * added.cloud
        means = tuple(_levels(exchange, first(field)) for field in (leaving[1], leaving[0]))
        return Solved(maps, added, means=(means[0], means[1]))

    def pictures(self, solved: Solved) -> dict[str, np.ndarray]:
        """`ground_map` and `cloud_map`: means of what the other side sends, one level above the other, (3 N, N, C)."""
        if solved.means is None:
            raise ValueError("another technique solved these maps")
        ground, cloud = (np.concatenate(list(means)) for means in solved.means)
        return {"ground_map": ground, "cloud_map": cloud}

    def numbers(self, half: float, centre: tuple[float, float] = (0.0, 0.0)) -> dict[str, Any]:
        """The square, and the levels' weights."""
        return {**super().numbers(half, centre), "bounce_weights": tuple(float(w) for w in level_weights(self.reading))}


def _levels(exchange: ThreeLevelExchange, field: np.ndarray) -> np.ndarray:
    """Means over the levels where the plane goes on with its mean: (C, N, N) to (3, N, N, C)."""
    mean = field.mean(axis=(-2, -1), keepdims=True)
    return np.stack([np.moveaxis(level + mean, 0, -1) for level in exchange.means(field - mean)]).astype(np.float32)
