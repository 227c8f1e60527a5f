"""What a technique of the directional textures adds to a technique: bakes, textures and numbers of its own."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from renderer.core.params import param
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

    def macros(self, baked: Mapping[str, Arrays]) -> Mapping[str, int]:
        """What of the bakes is compiled in, by macro."""
        return {}

    def textures_key(self, baked_keys: Mapping[str, str]) -> Hashable:
        """What `textures_of` depends on, beside the kind: names of files, keys of bakes; no live parameter."""
        return None

    def textures_of(self, gl: GL, baked: Mapping[str, Arrays]) -> dict[str, AnyTexture]:
        """Its samplers' textures by the names of `textures`; called on the GL thread when `textures_key` is new, and
        freed by the renderer."""
        return {}


class TexelSelection(DirectionalTechnique):
    """Which points the texels of the faces show."""

    count: ClassVar[int] = 1
    """Points that a texel takes, 1 or 4."""
    per_pixel: ClassVar[bool] = False
    """Whether pixels choose their points, and not texels."""

    magnification: Literal["nearest", "linear"] = param(
        "linear", label="Between texels", help="How a face's picture is read between its texels.", cost="host"
    )


SHADOW_CODE = "shadow_code"
"""Name of the bake of a self-shadow technique whose `words`, (M, W) uint32, `shadow_words` reads in the shader."""
