"""Names the shells' precomputations, so that every technique asks for the same ones."""

from __future__ import annotations

from typing import TYPE_CHECKING

from renderer.core.params import bake_arguments
from renderer.core.technique import Bake
from renderer.shells.base_picture import NoPicture, picture_bake
from renderer.shells.shell_bake import shell_bake as extruded_bake
from renderer.shells.surfaces import bake_surface
from renderer.shells.texture.sources import texture_bake
from renderer.shells.things import bake_things, thing_arguments
from renderer.world.sky import bake_sky

if TYPE_CHECKING:
    from renderer.shells.state import ShellsState


def sky_bake(state: ShellsState) -> Bake:
    """Sun and sky light by the sun's elevation."""
    return Bake("sky", bake_sky, bake_arguments(state.air), seconds=8)


def surface_bake(state: ShellsState) -> Bake:
    """The mesh under the shell."""
    return Bake("surface", bake_surface, bake_arguments(state.surface), seconds=1)


def shell_bake(state: ShellsState) -> Bake:
    """The shell's tetrahedra."""
    return extruded_bake(state.extrusion, surface_bake(state))


def bakes(state: ShellsState) -> list[Bake]:
    """Every precomputation a state needs, inputs first, each once."""
    wanted = [sky_bake(state), surface_bake(state), shell_bake(state), texture_bake(state.texture)]
    if not isinstance(state.picture, NoPicture) and state.base.opaque:
        wanted.append(picture_bake(state.picture))
    if state.things.list:
        wanted.append(Bake("things", bake_things, thing_arguments(state.things), version=3))
    for technique in state.techniques().values():
        wanted += technique.bakes(state)
    return list({(bake.name, str(bake.arguments)): bake for bake in wanted}.values())
