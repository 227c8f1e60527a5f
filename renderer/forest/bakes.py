"""Names the forest's precomputations, so that every technique asks for the same ones."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from renderer.core.params import bake_arguments
from renderer.core.technique import Bake
from renderer.forest.canopy_horizon import bake_canopy_horizon
from renderer.forest.ground import bake_ground
from renderer.forest.nursery import listed
from renderer.forest.pattern import bake_pattern
from renderer.forest.soft_horizon import bake_soft_horizon
from renderer.forest.terrain_horizon import bake_terrain_horizon
from renderer.world.sky import bake_sky

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


def ground_bake(state: ForestState) -> Bake:
    """Heights and forest cover over the square."""
    arguments: dict[str, Any] = {"terrain": bake_arguments(state.terrain), "cover": bake_arguments(state.cover)}
    if state.cover.species_map:
        arguments["planted"] = listed(bake_arguments(state.canopy))
    # Only a canopy height model asks how tall the pattern's own trees are.
    inputs = (pattern_bake(state),) if state.cover.local_heights else ()
    return Bake("terrain", bake_ground, arguments, inputs, version=3, seconds=1)


def pattern_bake(state: ForestState) -> Bake:
    """The texture-cell atlas."""
    apart = {"apart": True} if state.cover.species_map else {}
    return Bake("pattern", bake_pattern, bake_arguments(state.canopy) | apart, version=11, seconds=16)


def terrain_horizon_bake(terrain: Bake, sectors: int) -> Bake:
    """Terrain horizon in azimuth sectors."""
    return Bake("terrain_horizon", bake_terrain_horizon, {"sectors": sectors}, (terrain,), version=3, seconds=3)


def canopy_horizon_bake(pattern: Bake, sectors: int, heights: list[float]) -> Bake:
    """Canopy horizon over the tile at each height."""
    return Bake(
        "canopy_horizon",
        bake_canopy_horizon,
        {"sectors": sectors, "heights": heights},
        (pattern,),
        version=2,
        seconds=5,
    )


def soft_horizon_bake(pattern: Bake, sectors: int, heights: list[float]) -> Bake:
    """Soft canopy horizons over the tile at each height."""
    return Bake("soft_horizon", bake_soft_horizon, {"sectors": sectors, "heights": heights}, (pattern,), seconds=8)


def sky_bake(state: ForestState) -> Bake:
    """Sun and sky light by elevation."""
    return Bake("sky", bake_sky, bake_arguments(state.air), seconds=8)


def bakes(state: ForestState) -> list[Bake]:
    """Every precomputation a state needs, inputs first, each once."""
    terrain, pattern = ground_bake(state), pattern_bake(state)
    wanted = [sky_bake(state), terrain, pattern]
    for technique in state.techniques().values():
        wanted += technique.bakes(state, terrain, pattern)
    return list({(bake.name, str(bake.arguments)): bake for bake in wanted}.values())
