"""Composes the forest's shaders from the chosen techniques."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from renderer.core.params import defines, uniform_declarations
from renderer.core.registry import glsl_file
from renderer.forest.state import Ground
from renderer.forest.textures import TILE_MAP
from renderer.gl.source import Source, assemble
from renderer.world.camera import CAMERA_DECLARATIONS
from renderer.world.sky import SKY_DECLARATIONS

if TYPE_CHECKING:
    from renderer.forest.state import ForestState
    from renderer.forest.technique import ForestTechnique

ENTRY_STEPS = 128
"""Safe steps a ray may take over the canopy before it meets it."""

SCOUT_BLOCK = 8
"""Pixels a side of the blocks whose way to the canopy is found once for all their rays."""

MARCH_STEPS = 1024
"""Steps a ray may take inside the canopy layer."""

WORLD_DECLARATIONS = """uniform sampler2D heights;        // coefficients of each cell, as shares of terrain_range
uniform sampler2D normals;
uniform sampler2D cover;
uniform sampler3D pattern_voxels;
uniform sampler3D pattern_normal;
uniform sampler2D tiles;
uniform sampler2D scout;          // m: where the rays of a block of pixels begin, row 0 the top
uniform vec2 terrain_range;       // m
uniform float terrain_cell;       // m
uniform float terrain_nodes;
uniform float terrain_steepness;  // greatest rise over run
uniform float terrain_bend;       // m-1, greatest change of the slope along a line
uniform float tile_side;          // m
uniform float voxel_size;         // m
uniform float canopy_height;      // m
uniform float canopy_top;         // m, no tree is taller
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

FRAME_BODY = """// R4, the low-discrepancy sequence of Roberts 2018.
const vec4 JITTER_TURNS = vec4(0.8566748838545029, 0.7338918566271260, 0.6287067210378087, 0.5385972572236101);
layout(location = 0) out vec4 radiance;
void main() {
    vec2 corner = picture_pixel(gl_FragCoord.xy, picture_size) - 0.5;
    vec3 origin, direction;
    camera_ray(corner + pixel_offset, origin, direction);
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec4 jitter = fract(noise * vec4(1.0, 7.0, 13.0, 29.0) + vec4(0.0, 0.5, 0.25, 0.75) + sample_shift * JITTER_TURNS);
    float start = textureLod(scout, (floor((corner + 0.5) / SCOUT_BLOCK) + 0.5) / vec2(textureSize(scout, 0)), 0.0).r;
    radiance = forest_radiance(origin, direction, start, jitter);
#if BACKGROUND_SKY == 1
    radiance.rgb += (1.0 - radiance.a) * (sky_radiance(direction) + sky_sun_disc(direction));
    radiance.a = 1.0;
#endif
}"""

SCOUT_BODY = """layout(location = 0) out vec4 distance_found;
void main() {
    distance_found = vec4(scout_distance(gl_FragCoord.xy - 0.5));
}"""

PASS_BODY = """layout(location = 0) out vec4 texel;
void main() {
    texel = %s_%s_texel(gl_FragCoord.xy);
}"""


def frame_source(state: ForestState) -> Source:
    """The fragment stage of a frame."""
    chosen = tuple((slot, type(t), tuple(defines(t, slot).items())) for slot, t in state.techniques().items())
    return _frame(chosen, state.view.background == "sky")


Chosen = tuple[tuple[str, type["ForestTechnique"], tuple[tuple[str, str], ...]], ...]


@functools.lru_cache(maxsize=256)
def _frame(chosen: Chosen, sky: bool) -> Source:
    """Composed for techniques and their build parameters: live ones move without a new program."""
    files = ["lib/pixel.glsl", "lib/camera.glsl", "lib/sky.glsl"]
    files += ["forest/world.glsl", "forest/crossing.glsl", "forest/events.glsl"]
    files += [glsl_file("forest", slot, technique.model_fields["kind"].default) for slot, technique, _ in chosen]
    files += ["forest/shade.glsl", "forest/radiance.glsl"]
    declarations = [CAMERA_DECLARATIONS, SKY_DECLARATIONS, WORLD_DECLARATIONS, uniform_declarations(Ground, "ground")]
    macros = _limits() | {"BACKGROUND_SKY": int(sky)}
    for slot, technique, build in chosen:
        declarations += [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
        declarations += [uniform_declarations(technique, slot), *technique.extra_declarations]
        macros.update(build)
    return assemble(files, defines=macros, declarations="\n".join(declarations), body=FRAME_BODY)


@functools.lru_cache(maxsize=64)
def pass_source(slot: str, name: str, glsl: str, declarations: tuple[str, ...]) -> Source:
    """The fragment stage of a pass drawn from the sun, `glsl`, with the uniforms it declares."""
    text = "\n".join([WORLD_DECLARATIONS, uniform_declarations(Ground, "ground"), *declarations])
    return assemble([glsl], defines=_limits(), declarations=text, body=PASS_BODY % (slot, name))


@functools.lru_cache(maxsize=1)
def scout_source() -> Source:
    """The fragment stage that finds where the rays of each block of pixels begin."""
    text = "\n".join([CAMERA_DECLARATIONS, WORLD_DECLARATIONS, uniform_declarations(Ground, "ground")])
    files = ["lib/camera.glsl", "forest/world.glsl", "forest/scout.glsl"]
    return assemble(files, defines=_limits(), declarations=text, body=SCOUT_BODY)


def _limits() -> dict[str, str | int]:
    return {
        "ENTRY_STEPS": ENTRY_STEPS,
        "MARCH_STEPS": MARCH_STEPS,
        "TILE_MAP": f"{TILE_MAP}.0",
        "SCOUT_BLOCK": f"{SCOUT_BLOCK}.0",
    }
