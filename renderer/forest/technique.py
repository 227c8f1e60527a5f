"""What a forest technique adds to a technique: the bakes it needs and the textures it resolves for a frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.technique import Arrays, Bake, Technique
from renderer.gl.layers import Kind

if TYPE_CHECKING:
    from renderer.forest.state import ForestState


@dataclass(frozen=True)
class SunPass:
    """A picture drawn from the sun before the frame: the depth pass of a shadow map.

    Attributes:
        name: of the pass.
        glsl: file with `vec4 <slot>_<name>_texel(vec2 pixel)`, relative to the shader root; where it fills several
            samplers, with `void <slot>_<name>_texel(vec2 pixel, out vec4 texels[N])`.
        declarations: of the uniforms below.
        resolution: width of the target in texels.
        uniforms: what both the pass and the frame read; the pass is drawn again when one of them changes.
        layers: squares of that side which the target holds, one above the other.
        targets: components and moderngl's type of each sampler it fills, as named in the technique's `textures`, in the
            order of `texels`.
    """

    name: str
    glsl: str
    declarations: tuple[str, ...]
    resolution: int
    uniforms: Mapping[str, Any]
    layers: int = 1
    targets: Mapping[str, Kind] = field(default_factory=lambda: {"depth": (1, "f4")})


class ForestTechnique(Technique):
    """A technique of the forest.

    `textures` names its samplers; `frame_textures` fills them from what was baked, again each time `frame_key` changes,
    and `kept_textures` those that no sun changes.
    """

    extra_declarations: ClassVar[tuple[str, ...]] = ()
    """GLSL declarations of uniforms that are no live parameters: what `constants` and its pass give."""

    wrap: ClassVar[Mapping[str, Literal["clamp", "repeat"]]] = {}
    """How its textures continue beyond their edges; clamped where it does not say."""

    def bakes(self, state: ForestState, terrain: Bake, pattern: Bake) -> list[Bake]:
        """The precomputations this technique needs beside the terrain and the pattern."""
        return []

    def first_look(self) -> int:
        """Pixels a side of the blocks that share one look at the sun in a picture's first sample, which is smoothed; 1
        where its `first_sample` answers at each pixel, and 0 where nothing is smoothed."""
        return 0

    def first_pitch(self) -> int:
        """Pixels a side that share a ray of the eye in a picture's first sample, which is smoothed where that is not
        1."""
        return 1

    def first_sample(self) -> ForestTechnique:
        """What stands for it in a picture's first sample, the one that is shown while something moves."""
        return self

    def constants(self) -> dict[str, Any]:
        """Values of `extra_declarations` that follow from the technique's own parameters."""
        return {}

    def frame_key(self, state: ForestState) -> tuple[Any, ...]:
        """What its frame textures depend on."""
        return ()

    def frame_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Arrays (H, W) or (H, W, C) for its 2D samplers, row 0 at the south (texture coordinate 0), and (K, J, I) or
        (K, J, I, C) for its 3D ones, over the torus of the atlas; bytes stay bytes, all else becomes float32."""
        return {}

    def kept_textures(self, state: ForestState, baked: Mapping[str, Arrays]) -> dict[str, Sequence[np.ndarray]]:
        """Mip levels (K, J, I) or (K, J, I, C) of its 3D samplers, finest first, over the torus of the atlas: made once
        for what was baked, whatever the sun."""
        return {}

    def sun_pass(self, state: ForestState, baked: Mapping[str, Arrays], size: tuple[int, int]) -> SunPass | None:
        """The pass to draw from the sun for a picture of `size` (width, height), if the technique has one."""
        return None
