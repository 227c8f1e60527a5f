"""Composes the clouds' shaders from the chosen techniques."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from renderer.clouds.planet import Layer, Planet
from renderer.clouds.world_scale import AIR_TOP
from renderer.core.params import defines, uniform_declarations
from renderer.core.registry import glsl_file
from renderer.gl.source import Source, assemble
from renderer.world.camera import CAMERA_DECLARATIONS

if TYPE_CHECKING:
    from renderer.clouds.state import CloudsState
    from renderer.clouds.technique import CloudsTechnique

LAND_STEPS = 96
"""Steps that a ray may take over the land before it meets it."""

AIR_STEPS = 8
"""Points of each stretch of air, where a parallel view has to walk it."""

AIR_AROUND, AIR_ROWS, AIR_SLICES = 32, 64, 12
"""Azimuths, directions and distances of the table of the air, as in shaders/clouds/air_table.glsl."""

WORLD_DECLARATIONS = """uniform sampler2D air_beam;
uniform sampler2D air_glow;
uniform sampler2D air_skylight;
uniform sampler2D globe_albedo;
uniform sampler2D land_heights;
uniform sampler2D land_horizon;
uniform sampler2D cloud_map;
uniform sampler2D cloud_systems;
uniform sampler2D air_light;      // of the camera's place, W m-2 sr-1
uniform sampler2D air_passed;     // optical depths of the same
uniform sampler2D traced;         // distance to the ground, m, and its normal
uniform sampler2D traced_albedo;
uniform vec3 air_up;              // of the camera
uniform vec3 air_ahead;           // level, towards the sun
uniform float air_horizon;        // rad from the zenith
uniform float air_limb;           // rad, where air begins for a camera above it
uniform float air_haze;           // against very clear air
uniform vec3 globe_east;          // unit vectors of the Earth's axes in the site's: to 90 E, ...
uniform vec3 globe_north;
uniform vec3 globe_up;
uniform float land_cell;          // m
uniform float land_top;           // m, nothing of the land is higher
uniform float land_steepness;     // greatest rise over run
uniform float layer_highest;      // greatest thickness against the layer's
uniform vec2 cloud_drift;         // m, of the map with the wind
uniform float cloud_side;         // m, of the map
uniform float cloud_repeats;      // 1 where it goes on beyond its edges
uniform float cloud_systems_side; // m
uniform vec3 sun_direction;
uniform vec3 sun_irradiance;      // above the air, W m-2
uniform float pixel_angle;        // rad, width of a pixel in perspective
uniform vec2 picture_size;
uniform vec2 pixel_offset;        // of the sample within its pixel, from the top-left corner"""

RAY_OF_PIXEL = """void pixel_ray(out vec3 origin, out vec3 direction) {
    camera_ray(picture_pixel(gl_FragCoord.xy, picture_size) - 0.5 + pixel_offset, origin, direction);
}
"""

TRACE_BODY = """layout(location = 0) out vec4 found;
layout(location = 1) out vec4 albedo;
void main() {
    vec3 origin, direction;
    pixel_ray(origin, direction);
    Path path = path_of(origin, direction);
    float t = ground_distance(path, origin, direction, pixel_angle);
    vec3 point = origin + t * direction, up = up_at(point);
    vec2 place = place_of(point);
    found = t < NEVER ? vec4(t, land_normal(place, up)) : vec4(-1.0);
    albedo = vec4(ground_albedo(point, up, place, path_altitude(path, t), pixel_angle * t), 1.0);
}"""

AIR_BODY = """layout(location = 0) out vec4 texel;
void main() {
    texel = vec4(air_texel(gl_FragCoord.xy, %s), 1.0);
}"""

SHADE_BODY = """layout(location = 0) out vec4 radiance;
void main() {
    vec3 origin, direction;
    pixel_ray(origin, direction);
    vec4 ground = texelFetch(traced, ivec2(gl_FragCoord.xy), 0);
    vec3 albedo = texelFetch(traced_albedo, ivec2(gl_FragCoord.xy), 0).rgb;
    radiance = radiance_along(origin, direction, ground, albedo, pixel_angle);
}"""

WORLD_FILES = ("lib/pixel.glsl", "lib/camera.glsl", "clouds/path.glsl", "clouds/layer.glsl", "clouds/air.glsl")

Chosen = tuple[tuple[str, type["CloudsTechnique"], tuple[tuple[str, str], ...]], ...]

SHADE_SLOTS = ("geometry", "phase", "scattering", "cloud_shadow", "bounce")
"""Slots whose functions the picture calls, in the order in which they build on each other."""


@functools.cache
def trace_source() -> Source:
    """The fragment stage that finds the ground; no sun and no cloud is in it."""
    return _world((*WORLD_FILES, "clouds/ground.glsl"), RAY_OF_PIXEL + TRACE_BODY)


@functools.cache
def air_source(light: bool) -> Source:
    """The fragment stage that fills the table of the air's light as the camera sees it, or of its optical depth."""
    return _world((*WORLD_FILES, "clouds/air_table.glsl"), AIR_BODY % ("true" if light else "false"))


def _world(files: tuple[str, ...], body: str) -> Source:
    return assemble(files, defines=_limits(), declarations=world_declarations(), body=body)


def shade_source(state: CloudsState) -> Source:
    """The fragment stage that draws a picture before and behind the ground that was traced."""
    chosen = state.techniques()
    parts = tuple((slot, type(chosen[slot]), tuple(defines(chosen[slot], slot).items())) for slot in SHADE_SLOTS)
    return _composed(parts, state.view.background == "sky", state.camera.kind != "orthographic")


@functools.lru_cache(maxsize=256)
def _composed(chosen: Chosen, sky: bool, table: bool) -> Source:
    files = [*WORLD_FILES, "clouds/air_table.glsl", "clouds/air_look.glsl", "clouds/ground.glsl"]
    declarations = [world_declarations()]
    macros: dict[str, str | int] = _limits() | {"BACKGROUND_SKY": int(sky), "AIR_TABLE": int(table)}
    for slot, technique, build in chosen:
        files += technique.includes
        files.append(glsl_file("clouds", slot, technique.model_fields["kind"].default))
        declarations += technique_declarations(slot, technique)
        macros.update(build)
    files += ["clouds/cloud.glsl", "clouds/frame.glsl"]
    return assemble(files, defines=macros, declarations="\n".join(declarations), body=RAY_OF_PIXEL + SHADE_BODY)


def world_declarations() -> str:
    """Uniforms of camera, planet, layer and maps."""
    models = (uniform_declarations(Layer, "layer"), uniform_declarations(Planet, "planet"))
    return "\n".join([CAMERA_DECLARATIONS, WORLD_DECLARATIONS, *models])


def technique_declarations(slot: str, technique: type[CloudsTechnique]) -> list[str]:
    """Samplers and uniforms of a technique."""
    samplers = [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
    return [*samplers, uniform_declarations(technique, slot), *technique.extra_declarations]


def _limits() -> dict[str, str | int]:
    return {
        "LAND_STEPS": LAND_STEPS,
        "AIR_STEPS": AIR_STEPS,
        "AIR_CEILING": repr(AIR_TOP),
        "AIR_SLICES": f"{AIR_SLICES}.0",
    }
