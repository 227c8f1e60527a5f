"""Environment mapping: a mirror's picture of the surroundings over what they send to matt matter."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from renderer.core.params import param
from renderer.core.technique import Arrays, Bake
from renderer.directional.environment_light import SHARPEST, level_of
from renderer.directional.environments import DECLARATIONS, environment_bake, environment_values
from renderer.directional.technique import DirectionalTechnique
from renderer.world.sky import sky_for
from renderer.world.sun import angles, direction

if TYPE_CHECKING:
    from renderer.gl.context import GL
    from renderer.gl.program import AnyTexture


def surroundings(state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
    """Values of the declarations of `renderer.directional.environments` at the state's moment."""
    now, sun = sky_for(baked["sky"], angles(state.sun)[1]), direction(state.sun)
    return environment_values(state.environment, baked, now, np.asarray(sun))


def picture_texture(gl: GL, baked: Mapping[str, Arrays]) -> dict[str, AnyTexture]:
    """The surroundings' picture with its smoother levels; nothing of the sky's, which has a picture of its own."""
    if "environment" not in baked:
        return {}
    arrays = baked["environment"]
    levels = [arrays["image"], *(arrays[f"level_{k}"] for k in range(1, int(arrays["levels"]) + 1))]
    halves = [_half(level) for level in levels]
    texture = gl.texture2d(halves[0], "linear", "repeat", halves[1:])
    texture.repeat_y = False
    return {"environment": texture}


def _half(level: np.ndarray) -> np.ndarray:
    filled = np.concatenate([level, np.ones_like(level[..., :1])], axis=-1)
    return np.minimum(filled, 65504.0).astype(np.float16)


class EnvironmentMap(DirectionalTechnique):
    """Points mirror their surroundings and are lit by all of them."""

    title: ClassVar[str] = "Environment"
    caption: ClassVar[str] = "A mirror of the sky or of a picture, over the light that all of it sends to matt matter."
    paper: ClassVar[str] = "Blinn & Newell 1976; Ramamoorthi & Hanrahan 2001"
    includes: ClassVar[tuple[str, ...]] = ("lib/sky.glsl", "directional/environment_light.glsl")
    textures: ClassVar[Mapping[str, str]] = {"environment": "sampler2D"}
    extra_declarations: ClassVar[tuple[str, ...]] = (DECLARATIONS, "uniform float light_level; // of the picture")

    kind: Literal["environment"] = "environment"
    diffuse: float = param(
        0.6, label="Diffuse", help="Share of the light that is returned to all sides.", unit="ratio", ge=0, le=1
    )
    specular: float = param(
        0.35, label="Mirror", help="Share of the light that is mirrored.", unit="ratio", ge=0, le=1
    )
    shininess: float = param(
        SHARPEST,
        label="Shininess",
        help="Exponent of the lobe through which a picture is mirrored; at its most it is a mirror. The sky is always "
        "mirrored sharp.",
        cost="host",
        ge=2,
        le=SHARPEST,
        source="Kautz & McCool 2000",
    )

    def bakes(self, state: Any) -> list[Bake]:
        """The surroundings' picture."""
        return environment_bake(state.environment)

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """The surroundings' light at the moment."""
        return surroundings(state, baked) | {"light_level": level_of(self.shininess)}

    def textures_key(self, baked_keys: Mapping[str, str]) -> Hashable:
        """The picture."""
        return baked_keys.get("environment")

    def textures_of(self, gl: GL, baked: Mapping[str, Arrays]) -> dict[str, AnyTexture]:
        """The picture."""
        return picture_texture(gl, baked)
