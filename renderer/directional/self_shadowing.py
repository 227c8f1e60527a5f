"""What the techniques of the slot self_shadow have in common: a code of each point's hemisphere, baked."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any, ClassVar

from renderer.core.technique import Arrays, Bake
from renderer.directional.codes.baking import bake_code
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.technique import DirectionalTechnique


def _shadows_of(state: Any) -> Bake:
    # These name every technique's bakes, and so import them.
    bake: Bake = import_module("renderer.directional.bakes").shadows_bake(state)
    return bake


LAYOUT_DECLARATIONS = ("uniform int self_shadow_azimuths;", "uniform int self_shadow_elevations;")


class SelfShadowTechnique(DirectionalTechnique):
    """A technique that reads words of each point."""

    extra_declarations: ClassVar[tuple[str, ...]] = LAYOUT_DECLARATIONS
    includes: ClassVar[tuple[str, ...]] = ("directional/shadow_code.glsl",)

    @property
    def code_size(self) -> int:
        """Bytes of a point, where the code leaves a choice."""
        return int(getattr(self, "size", 0))

    @property
    def code_name(self) -> str:
        """The code's name, by default the technique's kind."""
        return str(getattr(self, "kind"))  # noqa: B009 - declared by each technique

    def bakes(self, state: Any) -> list[Bake]:
        """The words of all points."""
        shadows = _shadows_of(state)
        directions = int(shadows.arguments["directions"])
        arguments = {"code": self.code_name, "size": self.code_size, "directions": directions}
        seconds = 1 + 6e-6 * state.cloud.points
        return [Bake("shadow_code", bake_code, arguments, (shadows,), seconds=seconds)]

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """The layout of the masks."""
        layout = hemisphere_of(int(_shadows_of(state).arguments["directions"]))
        return {"self_shadow_azimuths": layout.azimuths, "self_shadow_elevations": layout.elevations}
