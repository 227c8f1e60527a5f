"""Names the clouds' precomputations, so that every technique asks for the same ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from renderer.clouds.air import bake_air
from renderer.clouds.cloud_map import bake_fields
from renderer.clouds.globe import bake_globe
from renderer.clouds.land import bake_land
from renderer.clouds.phase.mie import Mie
from renderer.core.params import bake_arguments
from renderer.core.technique import Bake
from renderer.world.sky import bake_sky

if TYPE_CHECKING:
    from renderer.clouds.state import CloudsState


def sky_bake(state: CloudsState) -> Bake:
    """Sun and sky light on the ground by the sun's elevation."""
    return Bake("sky", bake_sky, bake_arguments(state.air), seconds=8)


def air_bake(state: CloudsState) -> Bake:
    """Tables of the air, for every height."""
    return Bake("air", bake_air, bake_arguments(state.air), version=2, seconds=2)


def globe_bake() -> Bake:
    """Albedo of the Earth."""
    return Bake("globe", bake_globe, {}, seconds=1)


def land_bake(state: CloudsState) -> Bake:
    """Land around the site."""
    return Bake("land", bake_land, bake_arguments(state.land), version=7, seconds=2)


def fields_bake(state: CloudsState) -> Bake:
    """What the cloud map is made of."""
    return Bake("fields", bake_fields, bake_arguments(state.clouds), version=7, seconds=3)


def droplets_bake(state: CloudsState) -> Bake:
    """The phase function of the droplets that are there, whatever technique draws them."""
    phase: Any = state.techniques()["phase"]
    drawn: Bake = (phase if phase.kind == "mie" else Mie()).phase_bake()
    return drawn


def world_bakes(state: CloudsState) -> list[Bake]:
    """What the world is made of, for whoever draws it without the techniques."""
    return [globe_bake(), land_bake(state), fields_bake(state), droplets_bake(state)]


def bakes(state: CloudsState) -> list[Bake]:
    """Every precomputation a state needs, inputs first, each once."""
    wanted = [sky_bake(state), air_bake(state), globe_bake(), land_bake(state), fields_bake(state)]
    for technique in state.techniques().values():
        wanted += technique.bakes(state)
    return list({(bake.name, str(bake.arguments)): bake for bake in wanted}.values())
