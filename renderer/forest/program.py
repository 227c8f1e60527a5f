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
    from renderer.forest.state import ForestState, Macros
    from renderer.forest.technique import ForestTechnique

ENTRY_STEPS = 128
"""Safe steps a ray may take over the canopy before it meets it."""

SCOUT_BLOCKS = (16, 4)
"""Pixels a side of the blocks whose way to the canopy is found once for all their rays, one after the other."""

MARCH_STEPS = 1024
"""Steps a ray may take inside the canopy layer."""

WORLD_DECLARATIONS = """uniform sampler2D heights;        // coefficients of each cell, as shares of terrain_range
uniform sampler2D normals;         // of the ground, and its cover
uniform sampler2D cover;           // share of the trees that stand, and metres to the next
uniform sampler2D species;         // of 255: the one that stands there, from 1, 0 where all are mixed; and its section
uniform sampler2DArray species_voxels; // coarser levels of each section, one above the other
uniform sampler2D growth;          // height of the stands against the pattern's
uniform sampler2DArray pattern_voxels;
uniform sampler3D pattern_normal;
uniform sampler2D tiles;
uniform sampler2D scout;          // m: where the rays of a block of pixels begin, row 0 the top
uniform sampler2D traced_place;   // m along the ray, and normalised height, raised in wood: where light is looked at
uniform sampler2D traced_voxel;   // what stands there, and the ray's opacity
uniform vec2 terrain_range;       // m
uniform float terrain_cell;       // m
uniform float terrain_nodes;
uniform float terrain_steepness;  // greatest rise over run
uniform float terrain_bend;       // m-1, greatest change of the slope along a line
uniform float tile_side;          // m
uniform float voxel_size;         // m
uniform float canopy_height;      // m
uniform float canopy_top;         // m, no tree is taller
uniform float canopy_least;       // height of the lowest stand against the pattern's
uniform float canopy_grade;       // greatest rise over run of the canopy's layer
uniform float scene_top;          // m, nothing stands higher
uniform float scene_reach;        // m, nothing farther is drawn
uniform float scene_fade;         // m, over which the land beyond the square fades out
uniform vec3 sun_direction;
uniform float sun_elevation;      // rad
uniform vec3 sun_irradiance;      // W m-2
uniform vec3 sky_irradiance;      // W m-2
uniform float pixel_angle;        // rad, width of a pixel in perspective
uniform float pixel_width;        // m, width of a pixel in a parallel view
uniform vec2 picture_size;
uniform vec2 pixel_offset;        // of the sample within its pixel, from the top-left corner
uniform float ray_pitch;          // pixels a side that share a ray
uniform float sample_smoothed;    // 1: over three by three rays, as first samples are; 0: not
uniform float sample_shift;       // number of the sample, which turns the jitter"""

LOOK_DECLARATIONS = """uniform sampler2D looked; // of each block: share of the sun at one of its pixels, and where
uniform sampler2D lit;    // what was lit so, and its distance in m
uniform sampler2D smooth_lit; // the same smoothed, as the picture has it"""

RAY_OF_PIXEL = """// From sample to sample the low-discrepancy sequence R4 of Roberts 2018; from pixel to pixel
// the interleaved gradient noise of Jimenez 2014, "Next Generation Post Processing in Call of Duty".
const vec4 JITTER_TURNS = vec4(0.8566748838545029, 0.7338918566271260, 0.6287067210378087, 0.5385972572236101);
// Top-left corner of a fragment's pixel; where ray_pitch by ray_pitch pixels share a ray, of one in their middle.
vec2 ray_corner(vec2 fragment) {
    return (picture_pixel(fragment, picture_size) - 0.5) * ray_pitch + 0.5 * (ray_pitch - 1.0);
}

vec4 pixel_ray(out vec2 corner, out vec3 origin, out vec3 direction) {
    corner = ray_corner(gl_FragCoord.xy);
    camera_ray(corner + pixel_offset, origin, direction);
    float noise = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
    vec4 jitter = fract(noise * vec4(1.0, 7.0, 13.0, 29.0) + vec4(0.0, 0.5, 0.25, 0.75) + sample_shift * JITTER_TURNS);
    // What is smoothed over three by three pixels looks at the light at each of nine levels once among them.
    vec2 third = mod(floor(gl_FragCoord.xy), 3.0);
    jitter.y = sample_smoothed > 0.0 ? fract((third.x + 3.0 * third.y) * 5.0 / 9.0 + 1.0 / 18.0) : jitter.y;
    return jitter;
}
"""

TRACE_BODY = """layout(location = 0) out vec2 place_found;
layout(location = 1) out vec4 voxel_found;
void main() {
    vec2 corner;
    vec3 origin, direction;
    vec4 jitter = pixel_ray(corner, origin, direction);
    float start = texelFetch(scout, ivec2(corner + 0.5) / %d, 0).r;
    Event event = forest_trace(origin, direction, start, jitter);
    float wood = wood_in(event.voxel) && event.place.w >= 0.0 ? WOOD : 0.0;
    place_found = vec2(dot(event.place.xyz - origin, direction), event.place.w + wood);
    voxel_found = vec4(event.voxel.xyz / 65535.0, event.opacity);
}"""

SHADE_BODY = """layout(location = 0) out vec4 radiance;
void main() {
    vec2 corner;
    vec3 origin, direction;
    vec4 jitter = pixel_ray(corner, origin, direction);
    vec2 found = texelFetch(traced_place, ivec2(gl_FragCoord.xy), 0).rg;
    vec4 voxel = texelFetch(traced_voxel, ivec2(gl_FragCoord.xy), 0);
    float level = level_at(found.x, jitter.z);
    float reached = found.y == NOTHING ? 0.0 : 1.0;
    vec4 place = vec4(origin + reached * found.x * direction, found.y);
    // A ray that reached nothing has no place: the faded share comes off the opacity of the others, right in the mean.
    float faded = reached * (1.0 - land_kept(place.xy));
    vec3 light = outgoing(place, vec4(voxel.xyz * 65535.0, 0.0), level, -direction);
#if LOOK > 0
    radiance = vec4(light, reached == 0.0 ? -1.0 : found.x);
#else
    radiance = before_sky((reached - faded) * light, voxel.w - faded, direction);
#endif
}"""

LOOK_BODY = """layout(location = 0) out vec4 look;
void main() {
    vec2 found;
    float number;
    ivec2 pixel = looking_pixel(ivec2(gl_FragCoord.xy), found, number);
    vec3 origin, direction;
    camera_ray(ray_corner(vec2(pixel) + 0.5) + pixel_offset, origin, direction);
    vec3 place = origin + (found.y == NOTHING ? 0.0 : found.x) * direction;
    float h = max(found.y >= WOOD ? found.y - WOOD : found.y, 0.0);
    look = vec4(shadow_visibility(place, h, atlas_coordinate(place.xy)), found, number);
}"""

SMOOTH_BODY = """layout(location = 0) out vec4 radiance;
void main() {
    vec2 corner;
    vec3 origin, direction;
    pixel_ray(corner, origin, direction);
    vec4 seen = smoothed(ivec2(gl_FragCoord.xy));
    float kept = seen.a < 0.0 ? 0.0 : land_kept((origin + seen.a * direction).xy);
    float opacity = kept * texelFetch(traced_voxel, ivec2(gl_FragCoord.xy), 0).w;
    radiance = before_sky(opacity * seen.rgb, opacity, direction);
}"""

SPREAD_BODY = """layout(location = 0) out vec4 radiance;
void main() {
    radiance = spread_out(picture_pixel(gl_FragCoord.xy, picture_size));
}"""

TRACE_SLOTS = ("geometry", "filter")
"""Slots that decide where a ray meets matter; the others decide what light leaves there."""

SCOUT_BODY = """layout(location = 0) out vec4 distance_found;
void main() {
    ivec2 block = ivec2(gl_FragCoord.xy);
    float t = %s;
    distance_found = vec4(scout_distance(vec2(block), %d.0, t));
}"""

PASS_BODY = """layout(location = 0) out vec4 texel;
void main() {
    texel = %s_%s_texel(gl_FragCoord.xy);
}"""

PASSES_BODY = """{outputs}
void main() {{
    vec4 texels[{count}];
    {slot}_{name}_texel(gl_FragCoord.xy, texels);
    {copies}
}}"""

Chosen = tuple[tuple[str, type["ForestTechnique"], tuple[tuple[str, str], ...]], ...]


def trace_source(state: ForestState) -> Source:
    """The fragment stage that finds where each ray looks at the light, and what stands there; no sun is in it."""
    body = TRACE_BODY % SCOUT_BLOCKS[-1]
    files = ("forest/crossing.glsl",), ("forest/trace.glsl",)
    return _composed(_chosen(state, TRACE_SLOTS), *files, body, True, state.macros)


def shade_source(state: ForestState, look: int = 0) -> Source:
    """The fragment stage that lights what was traced; with what `look_source` found where `look` is not 0, and into a
    picture that `smooth_source` brings to its place."""
    slots = tuple(slot for slot in state.techniques() if slot != "geometry")
    before, after = ("forest/matter.glsl",), ("forest/fading.glsl", "forest/shade.glsl")
    return _shading(state, slots, before, after, SHADE_BODY, look)


def look_source(state: ForestState, look: int) -> Source:
    """The fragment stage that looks for the sun from one pixel of each block, `look` pixels a side."""
    return _shading(state, ("shadow", "filter"), (), ("forest/first_look.glsl",), LOOK_BODY, look)


def smooth_source(state: ForestState, look: int) -> Source:
    """The fragment stage that smooths what was lit so and lays it before the sky."""
    return _shading(state, ("filter",), (), ("forest/fading.glsl", "forest/first_look.glsl"), SMOOTH_BODY, look)


def spread_source(state: ForestState, look: int) -> Source:
    """The fragment stage that brings what was smoothed, of fewer rays than pixels, to every pixel."""
    return _shading(state, ("filter",), (), ("forest/first_look.glsl",), SPREAD_BODY, look)


def _shading(
    state: ForestState, slots: tuple[str, ...], before: tuple[str, ...], after: tuple[str, ...], body: str, look: int
) -> Source:
    sky = state.view.background == "sky"
    return _composed(_chosen(state, slots), before, after, body, sky, state.macros, look)


def _chosen(state: ForestState, slots: tuple[str, ...]) -> Chosen:
    """Techniques by slot with their build parameters: live ones move without a new program."""
    chosen = state.techniques()
    return tuple((slot, type(chosen[slot]), tuple(defines(chosen[slot], slot).items())) for slot in slots)


@functools.lru_cache(maxsize=256)
def _composed(
    chosen: Chosen, before: tuple[str, ...], after: tuple[str, ...], body: str, sky: bool, cover: Macros, look: int = 0
) -> Source:
    files = ["lib/pixel.glsl", "lib/camera.glsl", "lib/sky.glsl", "lib/backdrop.glsl", "forest/world.glsl"]
    files += ["forest/events.glsl", *before]
    files += [glsl_file("forest", slot, technique.model_fields["kind"].default) for slot, technique, _ in chosen]
    files += after
    declarations = [CAMERA_DECLARATIONS, SKY_DECLARATIONS, WORLD_DECLARATIONS, uniform_declarations(Ground, "ground")]
    declarations += [LOOK_DECLARATIONS] if look else []
    macros = _limits(cover) | {"BACKGROUND_SKY": int(sky), "LOOK": look}
    for slot, technique, build in chosen:
        declarations += [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
        declarations += [uniform_declarations(technique, slot), *technique.extra_declarations]
        macros.update(build)
    return assemble(files, defines=macros, declarations="\n".join(declarations), body=RAY_OF_PIXEL + body)


@functools.lru_cache(maxsize=64)
def pass_source(
    slot: str, name: str, glsl: str, declarations: tuple[str, ...], cover: Macros = (), targets: int = 1
) -> Source:
    """The fragment stage of a pass drawn from the sun, `glsl`, with the uniforms it declares, into some textures at
    once; `cover` as `_limits`."""
    text = "\n".join([WORLD_DECLARATIONS, uniform_declarations(Ground, "ground"), *declarations])
    body = PASS_BODY % (slot, name) if targets == 1 else _several(slot, name, targets)
    return assemble([glsl], defines=_limits(cover), declarations=text, body=body)


def _several(slot: str, name: str, targets: int) -> str:
    """The main function of a pass that fills several textures."""
    outputs = "\n".join(f"layout(location = {n}) out vec4 texel_{n};" for n in range(targets))
    copies = "\n    ".join(f"texel_{n} = texels[{n}];" for n in range(targets))
    return PASSES_BODY.format(outputs=outputs, copies=copies, count=targets, slot=slot, name=name)


@functools.lru_cache(maxsize=len(SCOUT_BLOCKS))
def scout_source(number: int) -> Source:
    """The fragment stage that finds where the rays of each block of pixels begin, from the blocks before if any."""
    side = SCOUT_BLOCKS[number]
    start = f"texelFetch(scout, block / {SCOUT_BLOCKS[number - 1] // side}, 0).r" if number else "0.0"
    text = "\n".join([CAMERA_DECLARATIONS, WORLD_DECLARATIONS, uniform_declarations(Ground, "ground")])
    files = ["lib/camera.glsl", "forest/world.glsl", "forest/scout.glsl"]
    return assemble(files, defines=_limits(), declarations=text, body=SCOUT_BODY % (start, side))


def _limits(cover: Macros = ()) -> dict[str, str | int]:
    """Macros of every program, with those of the state (`ForestState.macros`)."""
    return {
        "LOCAL_CANOPY": 0,
        "SPECIES_MAP": 0,
        "LOOK": 0,
        "ENTRY_STEPS": ENTRY_STEPS,
        "MARCH_STEPS": MARCH_STEPS,
        "TILE_MAP": f"{TILE_MAP}.0",
        **dict(cover),
    }
