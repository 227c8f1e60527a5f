"""What a technique of the shells adds to a technique: bakes, textures and numbers of its own."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from renderer.core.technique import Arrays, Bake, Technique

if TYPE_CHECKING:
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame


class ShellsTechnique(Technique):
    """A technique of the shells."""

    extra_declarations: ClassVar[tuple[str, ...]] = ()
    """GLSL declarations of uniforms that are no live parameters: what `constants` and its passes give."""

    includes: ClassVar[tuple[str, ...]] = ()
    """Shader files that its own needs before it, relative to the shader root."""

    whole: ClassVar[bool] = False
    """Of the slot `sampling`: whether it lights a ray as a whole, by `sampling_begin` and `sampling_rest` before and
    after its segments."""

    tables: ClassVar[Mapping[str, tuple[str, str]]] = {}
    """3D tables that it reads, by the name of the sampler: a bake of its own and an array of it, interpolated, which
    repeat in u and v as the texture does."""

    def bakes(self, state: Any) -> list[Bake]:
        """The precomputations this technique needs beside the shell and its texture."""
        return []

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """Values of `extra_declarations` that no pass gives."""
        return {}

    def first_sample(self) -> tuple[ShellsTechnique, int]:
        """What stands for it in a picture's first sample, the one that is shown while something moves, and how many
        rays two by two pixels have there."""
        return self, 4


class ShadowTechnique(ShellsTechnique):
    """What the shell leaves of the sun: it may look from the sun before the frame."""

    def look(self, frame: Frame) -> tuple[dict[str, AnyTexture], dict[str, Any]]:
        """Draw what the sun sees, unless it is still there.

        Returns:
            Textures by the names of its samplers, and values of `extra_declarations`.
        """
        return {}, {}


class OrderTechnique(ShellsTechnique):
    """In which order the segments of a ray are put together."""

    def picture(self, frame: Frame) -> tuple[Any, dict[str, AnyTexture], dict[str, Any]]:
        """Prepare a sample.

        Returns:
            The stage that puts it before the background in one full-screen pass, with its textures and uniforms.
        """
        raise NotImplementedError


class AccumulationTechnique(ShellsTechnique):
    """How precisely the colours of segments are put together."""

    dtype: ClassVar[str]
    """moderngl's name of a target's component type."""

    def white_radiance(self) -> float:
        """What 1 stands for in a target [W m-2 sr-1]."""
        return 1.0
