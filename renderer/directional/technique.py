"""What a technique of the directional textures adds to a technique: bakes, textures and numbers of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from renderer.core.technique import Arrays, Bake, Technique

if TYPE_CHECKING:
    from renderer.gl.context import GL
    from renderer.gl.program import AnyTexture


class DirectionalTechnique(Technique):
    """A technique of the directional textures."""

    extra_declarations: ClassVar[tuple[str, ...]] = ()
    """GLSL declarations of uniforms that are no live parameters: what `constants` gives."""

    includes: ClassVar[tuple[str, ...]] = ()
    """Shader files that its own needs before it, relative to the shader root."""

    def bakes(self, state: Any) -> list[Bake]:
        """The precomputations this technique needs beside the points and what the faces see."""
        return []

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """Values of `extra_declarations`."""
        return {}

    def textures_of(self, gl: GL, baked: Mapping[str, Arrays]) -> dict[str, AnyTexture]:
        """Its samplers' textures by the names of `textures`; called on the GL thread when what was baked is new, and
        freed by the renderer."""
        return {}
