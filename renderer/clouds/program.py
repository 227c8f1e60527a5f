"""Composes the clouds' shaders from the chosen techniques."""

from __future__ import annotations

import functools
from dataclasses import dataclass
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

LAND_STEPS = 160
"""Cells of the land, coarse and fine, that a ray may be asked about before it meets it."""

LAND_BLOCK = 4
"""Pixels a side of the blocks from one pixel of which the ground is scouted."""

LAND_COARSEST = 5
"""Level of the coarsest cells: 32 nodes a side."""

AIR_STEPS = 8
"""Points of each stretch of air, where a parallel view has to walk it."""

AIR_AROUND, AIR_ROWS, AIR_SLICES = 24, 64, 10
"""Azimuths, directions and distances of the table of the air, as in shaders/clouds/air_table.glsl."""

WORLD_DECLARATIONS = """uniform sampler2D air_beam;
uniform sampler2D air_glow;
uniform sampler2D air_skylight;
uniform sampler2D globe_albedo;
uniform sampler2D land_heights;
uniform sampler2D land_horizon;
uniform sampler2D land_tops;       // m
uniform sampler2D cloud_map;
uniform sampler2D cloud_systems;
uniform sampler2D air_light;      // of the camera's place, W m-2 sr-1
uniform sampler2D air_passed;     // optical depths of the same
uniform sampler2D traced_scout;    // distance to the ground from one pixel of each block, m
uniform sampler2D traced_ground;   // distance to the ground, m, and its normal
uniform sampler2D traced_albedo;
uniform sampler2D traced_first;    // stretch in the layer: middle, m, optical depth, thickness, m, apparent cosine
uniform sampler2D traced_second;   // the next: middle, optical depth, apparent cosine; m to the air under the layer
uniform sampler2D traced_slopes;   // of the first one's upper side; shares that both leave of what is behind
uniform sampler2D traced_look;     // place in the air's tables (clouds/air_look.glsl), to the layer and to the end
uniform sampler2D traced_kept;     // share that the air before the layer keeps; what is shown (clouds/frame.glsl)
uniform sampler2D traced_past;     // share that all air and the layer keep; thickness over the ground, m
uniform vec2 camera_excess;        // m2, a pair
uniform vec3 air_up;              // of the camera
uniform vec3 air_ahead;           // level, towards the sun
uniform vec3 air_east;            // level, from which azimuths are counted in turns; half a turn is added
uniform float air_turn;           // of the sun
uniform float air_horizon;        // rad from the zenith
uniform float air_limb;           // rad, where air begins for a camera above it
uniform float air_haze;           // against very clear air
uniform vec3 globe_east;          // unit vectors of the Earth's axes in the site's: to 90 E, ...
uniform vec3 globe_north;
uniform vec3 globe_up;
uniform float land_cell;          // m
uniform float land_top;           // m, nothing of the land is higher
uniform float layer_highest;      // greatest thickness against the layer's
uniform vec2 cloud_drift;         // m, of the map with the wind
uniform float cloud_side;         // m, of the map
uniform float cloud_repeats;      // 1 where it goes on beyond its edges
uniform float cloud_widens;       // 1 where it may be laid wider far away
uniform vec3 sun_direction;
uniform vec3 sun_irradiance;      // above the air, W m-2
uniform float pixel_angle;        // rad, width of a pixel in perspective
uniform vec2 picture_size;
uniform vec2 pixel_offset;        // of the sample within its pixel, from the top-left corner"""

RAY_OF_PIXEL = """Path pixel_path(ivec2 pixel, out vec3 origin, out vec3 direction) {
    camera_ray(picture_pixel(vec2(pixel) + 0.5, picture_size) - 0.5 + pixel_offset, origin, direction);
#if AIR_TABLE == 1
    return path_from(origin, camera_excess, direction);
#else
    return path_of(origin, direction);
#endif
}
"""

SCOUT_BODY = """layout(location = 0) out float met;
void main() {
    vec3 origin, direction;
    ivec2 block = ivec2(gl_FragCoord.xy);
    Path path = pixel_path(min(block * LAND_BLOCK + LAND_BLOCK / 2, ivec2(picture_size) - 1), origin, direction);
    met = ground_distance(path, origin, direction, pixel_angle, 0.0);
}"""

GROUND_BODY = """layout(location = 0) out vec4 found;
layout(location = 1) out vec4 albedo;
void main() {
    vec3 origin, direction;
    Path path = pixel_path(ivec2(gl_FragCoord.xy), origin, direction);
    float t = ground_distance(path, origin, direction, pixel_angle, scouted(ivec2(gl_FragCoord.xy)));
    vec3 point = origin + t * direction, up = up_at(point);
    vec2 place = place_of(point);
    vec3 normal = land_normal(place, up);
    vec3 bare = ground_albedo(point, up, place, path_altitude(path, t), pixel_angle * t);
    found = t < NEVER ? vec4(t, normal) : vec4(-1.0);
    albedo = vec4(t < NEVER ? land_albedo(bare, normal, up, place, pixel_angle * t) : planet_albedo, 1.0);
}"""

AIR_BODY = """layout(location = 0) out vec4 texel;
void main() {
    texel = vec4(air_texel(gl_FragCoord.xy, %s), 1.0);
}"""

WORLD_FILES = ("lib/pixel.glsl", "lib/camera.glsl", "clouds/path.glsl", "clouds/layer.glsl", "clouds/air.glsl")

Chosen = tuple[tuple[str, type["CloudsTechnique"], tuple[tuple[str, str], ...]], ...]

@dataclass(frozen=True)
class Variant:
    """What of a picture's case is compiled into its shaders.

    Attributes:
        sky: whether the sun's disc stands behind.
        table: whether all rays start at the camera, so that the air's table serves them.
        side: of the layer where that is: -1 below its base, 1 above all of it, 0 inside or anywhere.
        twilight: whether the sun may stand below the horizon of what is seen.
        land: whether any stands on the sphere.
    """

    sky: bool
    table: bool
    side: int
    twilight: bool
    land: bool


def scout_source(variant: Variant) -> Source:
    """The fragment stage that finds the ground from one pixel of each block."""
    return composed((), variant, ("clouds/ground.glsl",), SCOUT_BODY)


def ground_source(variant: Variant) -> Source:
    """The fragment stage that finds the ground; no sun and no cloud is in it."""
    return composed((), variant, ("clouds/ground.glsl",), GROUND_BODY)


def air_source(variant: Variant, light: bool) -> Source:
    """The fragment stage that fills the table of the air's light as the camera sees it, or of its optical depth."""
    return composed((), variant, ("clouds/air_table.glsl",), AIR_BODY % ("true" if light else "false"))


def chosen_of(state: CloudsState, slots: tuple[str, ...]) -> Chosen:
    """The techniques of some slots, with their macros."""
    chosen = state.techniques()
    return tuple((slot, type(chosen[slot]), tuple(defines(chosen[slot], slot).items())) for slot in slots)


@functools.lru_cache(maxsize=256)
def composed(
    chosen: Chosen, variant: Variant, after: tuple[str, ...], body: str, extra: tuple[str, ...] = ()
) -> Source:
    """A fragment stage.

    Args:
        chosen: techniques that it calls. after: files behind theirs. body: its `main`. extra: macros that are defined.
    """
    files = [*WORLD_FILES]
    declarations = [world_declarations()]
    macros: dict[str, str | int] = _limits() | {
        "BACKGROUND_SKY": int(variant.sky),
        "AIR_TABLE": int(variant.table),
        "CAMERA_SIDE": variant.side,
        "TWILIGHT": int(variant.twilight),
        "LAND": int(variant.land),
        **dict.fromkeys(extra, 1),
    }
    for slot, technique, build in chosen:
        files += technique.includes
        files.append(glsl_file("clouds", slot, technique.model_fields["kind"].default))
        declarations += technique_declarations(slot, technique)
        macros.update(build)
    files += after
    return assemble(files, defines=macros, declarations="\n".join(declarations), body=RAY_OF_PIXEL + body)


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
        "LAND_BLOCK": LAND_BLOCK,
        "LAND_COARSEST": LAND_COARSEST,
        "AIR_STEPS": AIR_STEPS,
        "AIR_CEILING": repr(AIR_TOP),
        "AIR_SLICES": f"{AIR_SLICES}.0",
    }
