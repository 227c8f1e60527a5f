"""Composes the forest's shaders from the chosen techniques."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from renderer.core.params import defines, uniform_declarations
from renderer.core.registry import glsl_file
from renderer.forest.state import SLOTS, Ground
from renderer.forest.textures import TILE_MAP
from renderer.gl.source import Source, assemble
from renderer.world.camera import CAMERA_DECLARATIONS
from renderer.world.sky import SKY_DECLARATIONS

if TYPE_CHECKING:
    from renderer.forest.state import ForestState
    from renderer.forest.technique import ForestTechnique, SunPass

ENTRY_STEPS = 128
"""Safe steps a ray may take over the canopy before it meets it."""

MARCH_STEPS = 512
"""Steps a ray may take inside the canopy layer."""

LIGHT_EVENTS = 2
"""Levels of opacity at which a ray evaluates light; more cost more and a single frame has less noise."""

WORLD_DECLARATIONS = """uniform sampler2D heights;        // m: coefficients of each cell
uniform sampler2D normals;
uniform sampler2D cover;
uniform sampler3D pattern_voxels;
uniform sampler3D pattern_normal;
uniform sampler2D tiles;
uniform float terrain_cell;       // m
uniform float terrain_nodes;
uniform float terrain_steepness;  // greatest rise over run
uniform float tile_side;          // m
uniform float voxel_size;         // m
uniform float canopy_height;      // m
uniform float scene_top;          // m, nothing stands higher
uniform float scene_reach;        // m, nothing farther is drawn
uniform vec3 sun_direction;
uniform float sun_elevation;      // rad
uniform vec3 sun_irradiance;      // W m-2
uniform vec3 sky_irradiance;      // W m-2
uniform float pixel_angle;        // rad, width of a pixel in perspective
uniform float pixel_width;        // m, width of a pixel in a parallel view
uniform vec2 picture_size;
uniform vec2 pixel_offset;        // of the sample within its pixel, from the top-left corner
uniform float sample_shift;       // [0, 1), turns the jitter from sample to sample"""

FRAME_BODY = """const vec4 JITTER_TURNS = vec4(0.8566748838545029, 0.7338918566271260, 0.6287067210378087, 0.5385972572236101); // R4
layout(location = 0) out vec4 radiance;
void main() {
    vec2 corner = picture_pixel(gl_FragCoord.xy, picture_size) - 0.5;
    vec3 origin, direction;
    camera_ray(corner + pixel_offset, origin, direction);
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec4 jitter = fract(noise * vec4(1.0, 7.0, 13.0, 29.0) + vec4(0.0, 0.5, 0.25, 0.75) + sample_shift * JITTER_TURNS);
    radiance = forest_radiance(origin, direction, jitter);
#if BACKGROUND_SKY == 1
    radiance.rgb += (1.0 - radiance.a) * (sky_radiance(direction) + sky_sun_disc(direction));
    radiance.a = 1.0;
#endif
}"""

PASS_BODY = """layout(location = 0) out vec4 texel;
void main() {
    texel = %s_%s_texel(gl_FragCoord.xy);
}"""


def frame_source(state: ForestState) -> Source:
    """The fragment stage of a frame."""
    chosen = tuple(state.techniques().items())
    return _frame(chosen, state.view.background == "sky")


@functools.lru_cache(maxsize=256)
def _frame(chosen: tuple[tuple[str, ForestTechnique], ...], sky: bool) -> Source:
    files = [
        "lib/pixel.glsl",
        "lib/camera.glsl",
        "lib/sky.glsl",
        "forest/world.glsl",
        "forest/crossing.glsl",
        "forest/events.glsl",
    ]
    files += [glsl_file("forest", slot, technique.kind) for slot, technique in chosen]
    files += ["forest/shade.glsl", "forest/radiance.glsl"]
    declarations = [CAMERA_DECLARATIONS, SKY_DECLARATIONS, WORLD_DECLARATIONS, uniform_declarations(Ground, "ground")]
    macros: dict[str, str | int] = {
        "ENTRY_STEPS": ENTRY_STEPS,
        "MARCH_STEPS": MARCH_STEPS,
        "LIGHT_EVENTS": LIGHT_EVENTS,
        "TILE_MAP": f"{TILE_MAP}.0",
        "BACKGROUND_SKY": int(sky),
    }
    for slot, technique in chosen:
        declarations += [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
        declarations += [uniform_declarations(type(technique), slot), *technique.extra_declarations]
        macros.update(defines(technique, slot))
    return assemble(files, defines=macros, declarations="\n".join(declarations), body=FRAME_BODY)


def pass_source(slot: str, sun_pass: SunPass) -> Source:
    """The fragment stage of a pass drawn from the sun."""
    return _pass(slot, sun_pass.name, sun_pass.glsl, tuple(sun_pass.declarations))


@functools.lru_cache(maxsize=64)
def _pass(slot: str, name: str, glsl: str, declarations: tuple[str, ...]) -> Source:
    macros: dict[str, str | int] = {"ENTRY_STEPS": ENTRY_STEPS, "MARCH_STEPS": MARCH_STEPS, "TILE_MAP": f"{TILE_MAP}.0"}
    text = "\n".join([WORLD_DECLARATIONS, uniform_declarations(Ground, "ground"), *declarations])
    return assemble([glsl], defines=macros, declarations=text, body=PASS_BODY % (slot, name))


def slots() -> tuple[str, ...]:
    """The forest's slots in the order of composition."""
    return SLOTS
