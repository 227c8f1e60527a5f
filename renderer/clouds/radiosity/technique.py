"""What a technique of the slots `bounce` and `basis` gives: maps of added light, and how a shader reads them.

First light is mapped over a square (`renderer.clouds.first_light`), the technique adds bounces to the maps, and the
shader reads what was added. Both slots read one solution, so it is kept.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from renderer.clouds.first_light import bounce_maps, moment, reach
from renderer.clouds.radiosity.bases import HALF, Basis
from renderer.clouds.radiosity.maps import Bounced, BounceMaps
from renderer.clouds.technique import CloudsTechnique
from renderer.core.technique import Arrays
from renderer.world.sun import angles


@dataclass(frozen=True)
class InBasis:
    """A side's light as coefficients of a basis, (bands, n)."""

    basis: Basis
    coefficients: np.ndarray


@dataclass(frozen=True)
class Solved:
    """Irradiance that bounces add, in parts: what a shader sums.

    Attributes:
        maps: what was given.
        even: the part that lies on the grid.
        ground, cloud: the part that is left to a basis; none where there is no basis.
        means: of the radiosities that ground and base receive, by level (3, N, N, C); for techniques that gather so.
    """

    maps: BounceMaps
    even: Bounced
    ground: InBasis | None = None
    cloud: InBasis | None = None
    means: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def added(self) -> Bounced:
        """The whole, on the grid."""
        if self.ground is None or self.cloud is None:
            return self.even
        both = (np.moveaxis(side.basis.synthesise(side.coefficients), 0, -1) for side in (self.ground, self.cloud))
        return Bounced(*(grid + rest for grid, rest in zip((self.even.ground, self.even.cloud), both, strict=True)))


class BasisTechnique(CloudsTechnique):
    """Functions by which transfer matrices describe light."""

    textures: ClassVar[Mapping[str, str]] = {"ground_map": "sampler2D", "cloud_map": "sampler2D"}

    def chosen(self, coefficients: int, estimate: np.ndarray) -> Basis:
        """The functions.

        Args:
            coefficients: how many. estimate: radiosities that are to be described, (K, GRID, GRID).
        """
        raise NotImplementedError

    def pictures(self, solved: Solved) -> dict[str, np.ndarray]:
        """Its textures, (H, W, C) float32; row 0 at the south."""
        raise NotImplementedError

    def frame_key(self, state: Any) -> tuple[Any, ...]:
        """What the solution depends on."""
        return state.bounce.frame_key(state)

    def frame_textures(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """The coefficients of the state's solution."""
        return self.pictures(solved_of(state, baked))


class BounceTechnique(CloudsTechnique):
    """Light that bounces between ground and cloud base.

    Its GLSL defines `vec3 bounce_ground(vec2 place, BounceHere here)` and `vec3 bounce_cloud(...)`, the irradiance that
    bounces add to the ground and to the base from below, W m-2.
    """

    textures: ClassVar[Mapping[str, str]] = {"ground_map": "sampler2D", "cloud_map": "sampler2D"}
    includes: ClassVar[tuple[str, ...]] = ("clouds/bounce_square.glsl",)
    extra_declarations: ClassVar[tuple[str, ...]] = (
        "uniform vec2 bounce_centre; // m, of the square that carries bounced light",
        "uniform float bounce_half;  // m, half of its side",
    )

    def solve(self, maps: BounceMaps, basis: BasisTechnique | None, baked: Mapping[str, Arrays]) -> Solved:
        """What bounces add to the first light of some maps.

        Args:
            basis: the technique of that slot, for those that describe light by one.
            baked: arrays of this technique's bakes, by name.
        """
        raise NotImplementedError

    def pictures(self, solved: Solved) -> dict[str, np.ndarray]:
        """Its textures: `ground_map` and `cloud_map`, (N, N, C) float32, row 0 at the south."""
        return {
            "ground_map": np.asarray(solved.even.ground, np.float32),
            "cloud_map": np.asarray(solved.even.cloud, np.float32),
        }

    def numbers(self, half: float, centre: tuple[float, float] = (0.0, 0.0)) -> dict[str, Any]:
        """Values of `extra_declarations` for a square of a half side and a centre, m."""
        return {"bounce_centre": tuple(float(v) for v in centre), "bounce_half": float(half)}

    def frame_key(self, state: Any) -> tuple[Any, ...]:
        """What the solution depends on: sun, layer, clouds, moment, land and ground, and the techniques."""
        where = (state.layer, reach(state), state.clouds, moment(state), state.planet, state.land, state.air)
        return (angles(state.sun), *where, state.scattering, state.bounce, state.basis)

    def frame_textures(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Maps of the state's solution."""
        return self.pictures(solved_of(state, baked))

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """Those of the square around the site."""
        return self.numbers(HALF * reach(state))


KEPT: list[tuple[tuple[Any, ...], Mapping[str, Arrays], Solved]] = []
"""The last solutions, for both slots."""

KEEP = 4


def solved_of(state: Any, baked: Mapping[str, Arrays]) -> Solved:
    """The solution of a document, computed once for both slots.

    Args:
        baked: arrays of its bakes by name; the same arrays mean the same solution.
    """
    key = state.bounce.frame_key(state)
    for known, arrays, solved in KEPT:
        if known == key and all(arrays.get(name) is array for name, array in baked.items()):
            return solved
    solved = state.bounce.solve(bounce_maps(state, baked), state.basis, baked)
    KEPT[:] = [(key, dict(baked), solved), *KEPT[: KEEP - 1]]
    return solved
