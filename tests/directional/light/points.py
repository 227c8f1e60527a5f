"""Points of a surface with chosen light and view, shaded by a technique's GLSL through the probe."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from renderer.core.baking import bake_now
from renderer.core.cache import Cache
from renderer.core.params import bake_arguments, defines, uniform_declarations, uniforms
from renderer.core.registry import glsl_file
from renderer.core.technique import Arrays, Bake
from renderer.directional.frames import frames
from renderer.directional.lamp import Lamp
from renderer.directional.technique import DirectionalTechnique
from renderer.gl.context import GL
from renderer.gl.probe import probe
from renderer.gl.thread import GLThread
from renderer.world.atmosphere import Atmosphere
from renderer.world.sky import SKY_DECLARATIONS, SkyNow, bake_sky, sky_for, sky_uniforms
from renderer.world.sun import angles

SUN = np.array([900.0, 850.0, 700.0])
SKY = np.array([80.0, 110.0, 160.0])
COLOUR = np.array([0.6, 0.5, 0.3])
SHADE = 0.75
"""Visibility that the stand-in for a shadow technique gives of everything above a point's horizon."""

WORLD = """struct Surfel {
    uint index; vec3 position; vec3 normal; vec3 tangent; vec3 bitangent; vec3 colour; float openness;
};
uniform vec3 sun_direction;
uniform vec3 sun_irradiance;
uniform vec3 sky_irradiance;
float self_shadow_visibility(Surfel surfel, vec3 towards);"""

SHADOW = """
float self_shadow_visibility(Surfel surfel, vec3 towards) {
    return dot(surfel.normal, towards) > 0.0 ? %r : 0.0;
}
""" % SHADE  # noqa: UP031 - the braces are GLSL's

BODY = """Surfel surfel = Surfel(0u, position, normal, tangent, cross(normal, tangent), vec3(0.6, 0.5, 0.3), openness);
result = light_radiance(surfel, to_eye);"""


def kept(bake: Bake) -> Arrays:
    """What a bake gives, computed once for every run."""
    return bake_now(bake, Cache())


def sky_tables() -> Arrays:
    """The default sky."""
    return kept(Bake("sky", bake_sky, bake_arguments(Atmosphere())))


def random_directions(count: int, seed: int) -> np.ndarray:
    """Unit vectors of the upper hemisphere, even by solid angle."""
    rng = np.random.default_rng(seed)
    z, turn = rng.random(count), rng.random(count) * 2 * np.pi
    level = np.sqrt(1 - z * z)
    return np.stack([level * np.cos(turn), level * np.sin(turn), z], axis=-1)


def shaded(
    thread: GLThread,
    technique: DirectionalTechnique,
    baked: Mapping[str, Any],
    normals: np.ndarray,
    to_eye: np.ndarray,
    sun: np.ndarray,
    lamp: Lamp | None = None,
    positions: np.ndarray | None = None,
    openness: np.ndarray | None = None,
    surroundings: Mapping[str, Any] | None = None,
) -> np.ndarray:
    """Radiance (N, 3) of points, as the technique's own GLSL gives it.

    Args:
        normals, to_eye, positions: (N, 3). sun: unit vector (3,). openness: (N,).
        surroundings: fields of the state beside the lamp, where the technique reads some.
    """
    baked = {"visibility": {"box": np.array([[-1.0, -1, -1], [1, 1, 1]])}, **baked}
    lamp = lamp or Lamp()
    state = SimpleNamespace(lamp=lamp, **(surroundings or {}))
    sky = getattr(getattr(state, "environment", None), "kind", "") == "sky"
    count = len(normals)
    inputs = {
        "normal": normals,
        "tangent": frames(normals)[0],
        "to_eye": to_eye,
        "position": np.zeros((count, 3)) if positions is None else positions,
        "openness": np.ones(count) if openness is None else openness,
    }

    live = {**uniforms(technique, "light"), **uniforms(lamp, "lamp"), **technique.constants(state, baked)}
    values = {**live, "sun_direction": sun, "sun_irradiance": SUN, "sky_irradiance": SKY}
    narrow = {name: array.astype(np.float32) for name, array in inputs.items()}
    now = sky_for(baked["sky"], angles(state.sun)[1]) if sky else None
    if now is not None:
        values |= sky_uniforms(now, sun)
    return np.asarray(thread.call(_probed, technique, lamp, baked, narrow, values, now), np.float64)


def _probed(
    gl: GL,
    technique: DirectionalTechnique,
    lamp: Lamp,
    baked: Mapping[str, Any],
    inputs: Mapping[str, np.ndarray],
    values: Mapping[str, Any],
    now: SkyNow | None,
) -> np.ndarray:
    made = {f"light_{name}": texture for name, texture in technique.textures_of(gl, baked).items()}
    if now is not None:
        made["sky_view"] = gl.texture2d(now.view)
    own = [*technique.includes, glsl_file("directional", "light", technique.kind)]
    try:
        return probe(
            gl,
            own,
            BODY,
            inputs,
            3,
            uniforms=values,
            textures=made,
            declarations="\n".join([*declarations(technique), SKY_DECLARATIONS]),
            defines={**defines(technique, "light"), **technique.macros(baked), **defines(lamp, "lamp"),
                     "ENVIRONMENT_SKY": int(now is not None)},
        )
    finally:
        for texture in made.values():
            texture.release()


def declarations(technique: DirectionalTechnique) -> list[str]:
    """Everything that a technique's GLSL relies on."""
    samplers = [f"uniform {kind} light_{name};" for name, kind in technique.textures.items()]
    live = [uniform_declarations(type(technique), "light"), uniform_declarations(Lamp, "lamp")]
    return [WORLD, *live, *samplers, *technique.extra_declarations, SHADOW]


def local(normals: np.ndarray, directions: np.ndarray) -> np.ndarray:
    """Directions (N, 3) in the frames of normals."""
    tangents, bitangents = frames(normals)
    return np.stack([(directions * axis).sum(axis=-1) for axis in (tangents, bitangents, normals)], axis=-1)
