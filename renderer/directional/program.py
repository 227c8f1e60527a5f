"""Composes the shaders of the directional textures from the chosen techniques."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from renderer.core.params import defines, uniform_declarations
from renderer.core.registry import glsl_file
from renderer.directional.environments import DECLARATIONS as SURROUNDINGS_DECLARATIONS
from renderer.directional.environments import environment_macros
from renderer.directional.hemisphere import hemisphere_of
from renderer.directional.lamp import Lamp
from renderer.directional.tiles import TILE
from renderer.gl.source import Source, assemble
from renderer.world.camera import CAMERA_DECLARATIONS
from renderer.world.sky import SKY_DECLARATIONS

if TYPE_CHECKING:
    from renderer.core.technique import Arrays
    from renderer.directional.state import DirectionalState
    from renderer.directional.technique import DirectionalTechnique

POINT_DECLARATIONS = """uniform vec3 box_low;             // m from the middle of the box
uniform vec3 box_high;
uniform usampler2D surfels;
uniform usampler2D shadow_code;
uniform vec3 eye;                 // m from the middle of the box
uniform vec3 eye_direction;       // towards the eye in a parallel view
uniform int eye_parallel;
uniform vec2 picture_size;
uniform vec2 pixel_offset;        // of the sample within its pixel, from the top-left corner"""

SEEN_DECLARATIONS = """uniform usampler2DArray seen;     // point numbers
uniform usampler2DArray seen_depth;
uniform isampler2D seen_layer;    // of a direction and a face
uniform isampler2D seen_round;    // of four directions round a place of a face's hemisphere
uniform sampler2D tile_bounds;    // nearest and farthest of a block of pixels, m from the eye
uniform int strip_faces[3];       // that the strips of the picture of faces show"""

LIGHT_DECLARATIONS = """uniform vec3 sun_direction;
uniform vec3 sun_irradiance;      // W m-2
uniform vec3 sky_irradiance;      // W m-2"""

EYE = """vec3 towards_eye(vec3 place) {
    return eye_parallel == 1 ? eye_direction : normalize(eye - place);
}"""

SELECT_BODY = (
    EYE
    + """
#if SELECTION_COUNT == 1
layout(location = 0) out uint chosen;
#else
layout(location = 0) out uvec4 chosen;
layout(location = 1) out vec4 chosen_weights;
#endif
void main() {
#if PER_PIXEL == 1
    vec3 origin, direction;
    camera_ray(picture_pixel(gl_FragCoord.xy, picture_size) - 0.5 + pixel_offset, origin, direction);
    Entry entry = box_entry(origin, direction);
    vec3 to_eye = -direction;
    float before = dot(entry.place - origin, direction);
    vec2 range = max(texelFetch(tile_bounds, ivec2(gl_FragCoord.xy) / TILE, 0).xy - before, 0.0);
#else
    ivec2 at = ivec2(gl_FragCoord.xy);
    int face = strip_faces[at.x / TEXELS];
    Entry entry = Entry(face, face_place(face, (vec2(at.x % TEXELS, at.y) + 0.5) / float(TEXELS)));
    vec3 to_eye = towards_eye(entry.place);
    vec2 range = vec2(0.0, 1.0e30);
#endif
    uvec4 points;
    vec4 weights;
    selection_points(max(entry.face, 0), entry.place, to_eye, range, points, weights);
    if (entry.face < 0 || all(equal(points, uvec4(NO_POINT)))) discard;
#if SELECTION_COUNT == 1
    chosen = points.x;
#else
    chosen = points;
    chosen_weights = weights;
#endif
}"""
)

SHADE_DECLARATIONS = """uniform usampler2D chosen_points;
uniform sampler2D chosen_weights;"""

SHADE_BODY = (
    EYE
    + """
layout(location = 0) out vec4 radiance;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    uvec4 points = texelFetch(chosen_points, at, 0);
#if SELECTION_COUNT == 1
    Surfel surfel = surfel_of(points.x);
    radiance = vec4(light_radiance(surfel, towards_eye(surfel.position)), 1.0);
#else
    vec4 weights = texelFetch(chosen_weights, at, 0);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 4; k++) {
        bool none = points[k] == NO_POINT;
        Surfel surfel = surfel_of(none ? 0u : points[k]);
        vec3 light = light_radiance(surfel, towards_eye(surfel.position));
        sum += none ? vec4(0.0) : weights[k] * vec4(light, 1.0);
    }
    radiance = sum;
#endif
}"""
)

DRAW_DECLARATIONS = """uniform sampler2D shaded;
uniform int face_strips[6];       // strip of each face, or -1"""

BEHIND_DECLARATIONS = "uniform sampler2D light_environment;\n" + SURROUNDINGS_DECLARATIONS

DRAW_BODY = """layout(location = 0) out vec4 radiance;
void main() {
    vec3 origin, direction;
    camera_ray(picture_pixel(gl_FragCoord.xy, picture_size) - 0.5 + pixel_offset, origin, direction);
#if PER_PIXEL == 1
    vec4 light = texelFetch(shaded, ivec2(gl_FragCoord.xy), 0);
#else
    Entry entry = box_entry(origin, direction);
    int strip = entry.face < 0 ? -1 : face_strips[entry.face];
    vec2 at = face_coordinates(max(entry.face, 0), entry.place) * float(TEXELS);
    at = clamp(at, vec2(0.5), vec2(float(TEXELS) - 0.5)) + vec2(float(max(strip, 0) * TEXELS), 0.0);
    vec4 light = strip < 0 ? vec4(0.0) : texture(shaded, at / vec2(textureSize(shaded, 0)));
#endif
#if BACKGROUND_SKY == 1 && ENVIRONMENT_BEHIND == 1
    radiance = vec4(light.rgb + (1.0 - light.a) * environment_radiance(direction, 0.0), 1.0);
#else
    radiance = before_sky(light.rgb, light.a, direction);
#endif
}"""

FIRST = (
    "lib/pixel.glsl",
    "lib/camera.glsl",
    "directional/hemisphere.glsl",
    "directional/frames.glsl",
    "directional/surfel.glsl",
    "directional/faces.glsl",
)

Chosen = tuple[tuple[str, type["DirectionalTechnique"], tuple[tuple[str, str], ...]], ...]


@dataclass(frozen=True)
class Variant:
    """What of a picture's case is compiled into its shaders.

    Attributes:
        sky: whether the sky is behind. texels: of a face's side. directions: of a face's hemisphere.
        selection_count: points that a texel takes, 1 or 4. per_pixel: whether pixels choose, and not texels.
        shadow_blocks: texels of a point's shadow code. lights: macros of lamp, surroundings and material.
    """

    sky: bool
    texels: int
    directions: int
    selection_count: int
    per_pixel: bool
    shadow_blocks: int
    lights: tuple[tuple[str, str], ...]

    def defines(self) -> dict[str, str | int]:
        """Its macros."""
        layout = hemisphere_of(self.directions)
        return {
            "BACKGROUND_SKY": int(self.sky),
            "TEXELS": self.texels,
            "TILE": TILE,
            "VIEW_AZIMUTHS": layout.azimuths,
            "VIEW_ELEVATIONS": layout.elevations,
            "SELECTION_COUNT": self.selection_count,
            "PER_PIXEL": int(self.per_pixel),
            "SHADOW_BLOCKS": self.shadow_blocks,
            **dict(self.lights),
        }


def variant_of(state: DirectionalState, shadow_blocks: int, baked: Mapping[str, Arrays]) -> Variant:
    """What of a state and of its bakes' arrays is compiled in."""
    chosen = state.selection
    return Variant(
        state.view.background == "sky",
        state.visibility.texels,
        state.visibility.directions,
        chosen.count,
        chosen.per_pixel,
        shadow_blocks,
        (
            *defines(state.lamp, "lamp").items(),
            *environment_macros(state).items(),
            *((name, str(value)) for name, value in state.light.macros(baked).items()),
        ),
    )


def select_source(state: DirectionalState, variant: Variant) -> Source:
    """The fragment stage that finds which points are seen."""
    return composed(_chosen(state, ("selection",)), variant, (), SELECT_BODY, SEEN_DECLARATIONS)


def shade_source(state: DirectionalState, variant: Variant) -> Source:
    """The fragment stage that lights the points that are seen."""
    more = "\n".join([LIGHT_DECLARATIONS, SHADE_DECLARATIONS, uniform_declarations(Lamp, "lamp")])
    return composed(_chosen(state, ("self_shadow", "light")), variant, (), SHADE_BODY, more, seen=False)


def draw_source(variant: Variant) -> Source:
    """The fragment stage that draws the lit faces before the background."""
    behind = dict(variant.lights)["ENVIRONMENT_BEHIND"] == "1"
    files = ("lib/sky.glsl", "lib/backdrop.glsl", *(("directional/surroundings.glsl",) if behind else ()))
    more = "\n".join([DRAW_DECLARATIONS, BEHIND_DECLARATIONS if behind else ""])
    return composed((), variant, files, DRAW_BODY, more)


@functools.lru_cache(maxsize=256)
def composed(
    techniques: Chosen, variant: Variant, after: tuple[str, ...], body: str, more: str, seen: bool = True
) -> Source:
    """A fragment stage.

    Args:
        techniques: in the order in which their functions build on each other.
        after: files behind them. body: `main`. more: declarations of the stage's own.
        seen: whether it needs what the faces see.
    """
    files = [*FIRST] if seen else [*FIRST[:-1], "lib/sky.glsl"]
    declarations = [CAMERA_DECLARATIONS, SKY_DECLARATIONS, POINT_DECLARATIONS, more]
    if seen and SEEN_DECLARATIONS not in more:
        declarations.append(SEEN_DECLARATIONS)
    macros = variant.defines()
    for slot, technique, build in techniques:
        files += technique.includes
        files.append(glsl_file("directional", slot, technique.model_fields["kind"].default))
        declarations += technique_declarations(slot, technique)
        macros.update(build)
    return assemble([*files, *after], defines=macros, declarations="\n".join(declarations), body=body)


def technique_declarations(slot: str, technique: type[DirectionalTechnique]) -> list[str]:
    """Samplers and uniforms of a technique."""
    samplers = [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
    return [*samplers, uniform_declarations(technique, slot), *technique.extra_declarations]


def _chosen(state: DirectionalState, slots: tuple[str, ...]) -> Chosen:
    """Techniques with what they compile in."""
    taken = state.techniques()
    return tuple((slot, type(taken[slot]), tuple(defines(taken[slot], slot).items())) for slot in slots)
