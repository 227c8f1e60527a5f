"""What the techniques of the slot self_shadow have in common: a code of each point's hemisphere, baked."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from renderer.core.errors import LimitError
from renderer.core.technique import Arrays, Bake
from renderer.directional.bakes import shadows_bake
from renderer.directional.codes.baking import bake_code
from renderer.directional.hemisphere import Hemisphere, hemisphere_of
from renderer.directional.technique import SHADOW_CODE, DirectionalTechnique

if TYPE_CHECKING:
    from renderer.gl.context import GL
    from renderer.gl.program import AnyTexture

LAYOUT_DECLARATIONS = ("uniform int self_shadow_azimuths;", "uniform int self_shadow_elevations;")


class SelfShadowTechnique(DirectionalTechnique):
    """A technique that reads words of each point."""

    extra_declarations: ClassVar[tuple[str, ...]] = LAYOUT_DECLARATIONS
    includes: ClassVar[tuple[str, ...]] = ("directional/shadow_code.glsl",)
    most_directions: ClassVar[int] = 513
    """Of a hemisphere that its code can hold."""

    def bakes(self, state: Any) -> list[Bake]:
        """The words of all points.

        Raises:
            LimitError: finer hemispheres than its code can hold.
        """
        if state.hemispheres.directions > self.most_directions:
            raise LimitError("hemispheres.directions", f"are {state.hemispheres.directions:,}, too many for the code",
                             f"at most {self.most_directions} with {self.title.lower()}")  # fmt: skip
        shadows = shadows_bake(state)
        given = self.model_dump(include={"kind", "size"})
        arguments = {**given, "directions": state.hemispheres.directions}
        return [Bake(SHADOW_CODE, bake_code, arguments, (shadows,), seconds=1 + 6e-6 * state.cloud.points)]

    def layout(self, state: Any) -> Hemisphere:
        """Of the masks."""
        return hemisphere_of(state.hemispheres.directions)

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """The layout of the masks."""
        layout = self.layout(state)
        return {"self_shadow_azimuths": layout.azimuths, "self_shadow_elevations": layout.elevations}


class BookTechnique(SelfShadowTechnique):
    """A technique whose words are numbers of patterns in books."""

    includes: ClassVar[tuple[str, ...]] = (*SelfShadowTechnique.includes, "directional/shadow_books.glsl")
    textures: ClassVar[Mapping[str, str]] = {"book": "usampler2D"}

    def textures_key(self, baked_keys: Mapping[str, str]) -> Hashable:
        """The code's."""
        return baked_keys[SHADOW_CODE]

    def textures_of(self, gl: GL, baked: Mapping[str, Arrays]) -> dict[str, AnyTexture]:
        """The books."""
        return {"book": gl.texture2d(baked[SHADOW_CODE]["book"], filter="nearest")}
