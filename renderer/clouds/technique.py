"""What a clouds technique adds to a technique: the bakes it needs, and the textures and numbers made of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from renderer.clouds.slab import SlabModel
from renderer.core.technique import Arrays, Bake, Technique


class CloudsTechnique(Technique):
    """A technique of the clouds.

    `textures` names its samplers, which `kept_textures` fills from what was baked, whatever camera and sun.
    """

    extra_declarations: ClassVar[tuple[str, ...]] = ()
    """GLSL declarations of uniforms that are no live parameters: what `constants` gives."""

    includes: ClassVar[tuple[str, ...]] = ()
    """Shader files that its own needs before it, relative to the shader root."""

    def bakes(self, state: Any) -> list[Bake]:
        """The precomputations this technique needs; `state` names the other techniques by slot."""
        return []

    def kept_textures(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """Arrays (H, W[, C]) for its 2D samplers and (K, J, I[, C]) for its 3D ones, float32, read by linear
        interpolation and clamped at their edges."""
        return {}

    def frame_key(self, state: Any) -> tuple[Any, ...]:
        """What its frame textures depend on beside what was baked; empty where it has none."""
        return ()

    def frame_textures(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, np.ndarray]:
        """As `kept_textures`, for one sun and moment: made again each time `frame_key` changes."""
        return {}

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """Values of `extra_declarations`."""
        return {}


def padded(bands: np.ndarray) -> np.ndarray:
    """Three bands (.., 3) as four components: software rasterisers read these a fifth faster than three."""
    return np.concatenate([bands, np.zeros((*bands.shape[:-1], 1), bands.dtype)], axis=-1)


class PhaseTechnique(CloudsTechnique):
    """How one droplet scatters. Whatever it is, its bake `phase` holds what scattering techniques need of it."""

    extra_declarations: ClassVar[tuple[str, ...]] = (
        "uniform vec3 phase_asymmetry; // mean cosine of the scattering angle",
        "uniform vec3 phase_forward;   // share scattered by less than FORWARD_ANGLE",
        "uniform vec3 phase_spread;    // rad^2, mean square angle of that share",
    )

    def phase_bake(self) -> Bake:
        """The bake `phase`: arrays as `renderer.clouds.phase_tables.phase_arrays` gives them."""
        raise NotImplementedError

    def bakes(self, state: Any) -> list[Bake]:
        """The phase function's moments and tables."""
        return [self.phase_bake()]

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """Asymmetry, share and spread of the forward peak in each band."""
        names = ("asymmetry", "forward", "spread")
        return {f"phase_{name}": tuple(float(value) for value in baked["phase"][name]) for name in names}


class ScatteringTechnique(CloudsTechnique):
    """What a plane layer makes of a beam of light. Its bakes have the phase function's as their input."""

    conserves: ClassVar[bool] = True
    """Whether it claims that what is not reflected is let through."""

    def model(self, baked: Mapping[str, Arrays]) -> SlabModel:
        """What its GLSL computes, in float64; `baked` holds its bakes' arrays and `phase`, by name."""
        raise NotImplementedError
