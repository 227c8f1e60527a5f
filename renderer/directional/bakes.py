"""Names the precomputations of the directional textures, so that every technique asks for the same ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

from renderer.core.params import bake_arguments
from renderer.core.technique import Bake
from renderer.directional import cloud, visibility
from renderer.directional.shadow_hemispheres import bake_shadows
from renderer.directional.subjects import subject_bake
from renderer.world.sky import bake_sky

if TYPE_CHECKING:
    from renderer.directional.state import DirectionalState

SHADOW_RAYS_A_SECOND = 3e6


def sky_bake(state: DirectionalState) -> Bake:
    """Sun and sky light by the sun's elevation."""
    return Bake("sky", bake_sky, bake_arguments(state.air), seconds=8)


def cloud_bake(state: DirectionalState) -> Bake:
    """Points on the subject."""
    return cloud.cloud_bake(state.cloud, subject_bake(state.subject))


def visibility_bake(state: DirectionalState) -> Bake:
    """Which point each texel of each face sees from each direction."""
    return visibility.visibility_bake(state.visibility, subject_bake(state.subject), cloud_bake(state))


def shadows_bake(state: DirectionalState) -> Bake:
    """What each point sees of its own hemisphere."""
    inputs = (subject_bake(state.subject), cloud_bake(state), visibility_bake(state))
    rays = 0.6 * state.cloud.points * state.hemispheres.directions
    arguments = bake_arguments(state.hemispheres)
    return Bake("shadows", bake_shadows, arguments, inputs, seconds=2 + rays / SHADOW_RAYS_A_SECOND)


def bakes(state: DirectionalState) -> list[Bake]:
    """Every precomputation a state needs, inputs first, each once."""
    wanted = [
        sky_bake(state),
        subject_bake(state.subject),
        cloud_bake(state),
        visibility_bake(state),
        shadows_bake(state),
    ]
    for technique in state.techniques().values():
        wanted += technique.bakes(state)
    return list({(bake.name, str(bake.arguments)): bake for bake in wanted}.values())


def world_bakes(state: DirectionalState) -> list[Bake]:
    """The precomputations that the world is made of, whatever draws it."""
    return [sky_bake(state), subject_bake(state.subject), *state.light.bakes(state)]
