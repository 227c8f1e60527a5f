"""Composes the shells' shaders from the chosen techniques."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

from renderer.core.params import defines, uniform_declarations
from renderer.core.registry import glsl_file
from renderer.gl.source import Source, assemble
from renderer.shells.base_picture import Laid, laid_by
from renderer.shells.texture.strides import DECLARATIONS as CODED_DECLARATIONS
from renderer.shells.voxels import Base, Voxels
from renderer.shells.world_scale import OPAQUE
from renderer.world.camera import CAMERA_DECLARATIONS
from renderer.world.sky import SKY_DECLARATIONS

if TYPE_CHECKING:
    from renderer.shells.state import ShellsState
    from renderer.shells.technique import ShellsTechnique

INTERPOLATIONS = ("NEAREST", "STRAIGHT", "EXTINCTION")

WORLD_DECLARATIONS = """uniform sampler2D shell_tets;
uniform sampler2D shell_base;
uniform sampler3D shell_matter;
uniform sampler3D shell_normal;
uniform sampler2D entry_first;    // depth, and 4 tetrahedron + face where rays come in: layer 0
uniform sampler2D entry_odd;      // layers 1, 3, ...
uniform sampler2D entry_even;     // layers 2, 4, ...
uniform int entry_layers;
uniform int entry_height;         // px, of one layer
uniform int start_tet;            // that holds the camera, or -1
uniform float matter_scale;       // 1/m, what 1 in the texture stands for
uniform float reference_length;   // m, for which the texture's alpha is meant
uniform vec2 normal_coding;       // factor and summand that make a normal of what is read
uniform float filter_coarsest;    // level
uniform vec2 texture_slide;       // of u and v over the surface
uniform vec3 shell_size;          // of the texture's box along u, v, w: ratios count alone
uniform vec3 sun_direction;
uniform vec3 sun_irradiance;      // W m-2
uniform vec3 sky_irradiance;      // W m-2
uniform float pixel_angle;        // rad, width of a pixel in perspective
uniform float pixel_side;         // m, in a parallel view
uniform float sample_shift;       // number of the sample, which turns the jitter
uniform float buffer_white;       // W m-2 sr-1, that 1 stands for where drawn cells are blended
uniform vec2 picture_size;
uniform vec2 pixel_offset;        // of the sample within its pixel, from the top-left corner"""

ENTRY_DECLARATIONS = """uniform sampler2D entry_before;
uniform int layer_row;            // px, where the layer begins in its texture
uniform int before_row;"""

ENTRY_BODY = """flat in float number;
layout(location = 0) out vec2 entry;
void main() {
    entry = vec2(gl_FragCoord.z, number);
}"""

NEXT_ENTRY_BODY = """flat in float number;
layout(location = 0) out vec2 entry;
void main() {
    // Where the layer before found nothing, nothing is left. What lies in other rows has its depth rounded otherwise.
    vec2 before = texelFetch(entry_before, ivec2(gl_FragCoord.xy) + ivec2(0, before_row - layer_row), 0).xy;
    if (before.y < 0.0 || before.y == number || gl_FragCoord.z <= before.x + 5.0e-7) discard;
    entry = vec2(gl_FragCoord.z, number);
}"""

THINGS_DECLARATIONS = """uniform sampler2D thing_seen;     // light and distance (m) of other meshes, or 0
uniform sampler2D thing_map;      // of the sun's view of them: distance (m), and how it grows from texel to texel
uniform vec3 thing_origin;        // of the map's rays: corner, m
uniform vec3 thing_across;        // texels/m
uniform vec3 thing_down;
uniform vec3 thing_along;         // unit vector away from the sun
uniform float thing_texel;        // m
uniform float thing_side;         // texels"""

PICTURE_DECLARATIONS = """uniform sampler2D base_picture;  // linear reflectance of the surface, rows upwards
uniform vec3 picture_centre;     // the world's origin, m
uniform float picture_turn;      // share of a turn, eastwards
uniform vec2 picture_repeats;    // pictures a repeat of the texture"""

LAID = {None: 0, "globe": 1, "texture": 2}
"""How a picture is laid on the surface, to its number in `BASE_PICTURE`."""

WALK = """#if THINGS == 1
    thing_limit = thing_distance();
#endif
    bool met = %s;
    for (int layer = 0; layer < entry_layers && !met && sum.a < OPAQUE; layer++) {
        vec2 entry = entry_of(ray, pixel, layer);
        if (entry.y < 0.0) break;
#if THINGS == 1
        if (entry.x >= thing_limit) break;
#endif
        if (entry_behind(entry)) {
            base_met(ray, int(entry.y), BASE_FACE, entry.x, sum);
            break;
        }
        met = order_walk(ray, int(entry.y), max(entry.x, 0.0), sum);
    }"""

WALK_BODY = """layout(location = 0) out vec4 gathered;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Ray ray = pixel_ray(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
%s
    gathered = buffer_of(sum);
}"""

COMPOSE_BODY = """layout(location = 0) out vec4 radiance;
void main() {
    vec4 sum = %s;
    sum.rgb *= buffer_white;
#if THINGS == 1
    vec4 thing = texelFetch(thing_seen, ivec2(gl_FragCoord.xy), 0);
    if (thing.a > 0.0) sum += (1.0 - sum.a) * vec4(thing.rgb, 1.0);
#endif
    radiance = before_sky(sum.rgb, sum.a, pixel_ray(gl_FragCoord.xy).direction);
}"""

SPREAD_DECLARATIONS = """
uniform int first_before; // columns of rays before the picture's own, in the first row"""

FIRST = ("lib/pixel.glsl", "lib/camera.glsl", "lib/sky.glsl", "lib/backdrop.glsl", "shells/tetrahedra.glsl",
         "shells/pixel_ray.glsl")

Chosen = tuple[tuple[str, type["ShellsTechnique"], tuple[tuple[str, str], ...]], ...]

LIT_SLOTS = ("filter", "shadow", "light", "sampling", "accumulation", "order")
"""Slots whose functions a picture calls, in the order in which they build on each other."""


@dataclass(frozen=True)
class Variant:
    """What of a picture's case is compiled into its shaders."""

    sky: bool
    opaque: bool
    interpolation: str
    things: bool = False
    picture: Laid | None = None

    def defines(self) -> dict[str, str | int]:
        """Its macros."""
        words: dict[str, str | int] = {name: index for index, name in enumerate(INTERPOLATIONS)}
        return words | {
            "BACKGROUND_SKY": int(self.sky),
            "BASE_OPAQUE": int(self.opaque),
            "INTERPOLATION": self.interpolation.upper(),
            "OPAQUE": repr(OPAQUE),
            "THINGS": int(self.things),
            "BASE_PICTURE": LAID[self.picture],
        }


def variant_of(state: ShellsState) -> Variant:
    """What of a state is compiled in."""
    sky, things = state.view.background == "sky", bool(state.things.list)
    laid = laid_by(state.picture, state.base.opaque)
    return Variant(sky, state.base.opaque, state.voxels.interpolation, things, laid)


@functools.cache
def entry_sources() -> tuple[Source, Source]:
    """The fragment stages that find where rays come in: for the first time, and anew behind a layer before.

    They tell faces by their number and depths by the hardware's: small triangles shade many pixels that are not theirs.
    """
    return assemble([], body=ENTRY_BODY), assemble([], declarations=ENTRY_DECLARATIONS, body=NEXT_ENTRY_BODY)


def walk_source(state: ShellsState, inside: bool) -> Source:
    """The fragment stage that walks each ray through the shell, from the camera's cell where it is inside of one."""
    return composed(chosen(state, LIT_SLOTS), variant_of(state), ("shells/entry.glsl",), WALK_BODY % walk_loop(inside))


def walk_loop(inside: bool) -> str:
    """The lines that follow a ray from where it comes in to where it ends."""
    return WALK % ("order_walk(ray, start_tet, 0.0, sum)" if inside else "false")


def compose_source(state: ShellsState) -> Source:
    """The fragment stage that lays what was gathered before the background."""
    body = COMPOSE_BODY % "texelFetch(gathered, ivec2(gl_FragCoord.xy), 0)"
    return composed((), variant_of(state), (), body, "uniform sampler2D gathered;")


def spread_source(state: ShellsState, rays: int) -> Source:
    """The same, of fewer rays than pixels: `rays` for two by two."""
    body = COMPOSE_BODY % "spread_out(picture_pixel(gl_FragCoord.xy, picture_size))"
    more = "uniform sampler2D gathered;" + (SPREAD_DECLARATIONS if rays > 1 else "")
    return composed((), variant_of(state), ("shells/first_look.glsl",), body, f"#define FIRST_RAYS {rays}\n{more}")


def chosen(state: ShellsState, slots: tuple[str, ...]) -> Chosen:
    """Techniques with what they compile in."""
    taken = state.techniques()
    return tuple((slot, type(taken[slot]), tuple(defines(taken[slot], slot).items())) for slot in slots)


@functools.lru_cache(maxsize=256)
def composed(
    techniques: Chosen,
    variant: Variant,
    after: tuple[str, ...],
    body: str,
    more: str = "",
    version: tuple[int, int] = (3, 3),
) -> Source:
    """A fragment stage.

    Args:
        techniques: in the order in which their functions build on each other.
        after: files after them. body: `main`. more: declarations of the stage's own.
        version: of OpenGL, at least.
    """
    files = [*FIRST, "shells/things.glsl"] if variant.things else [*FIRST]
    declarations = [world_declarations(), THINGS_DECLARATIONS if variant.things else "",
                    PICTURE_DECLARATIONS if variant.picture else "", more]
    macros = variant.defines()
    if techniques:
        files += ["shells/matter.glsl", "shells/coded.glsl"]
    for slot, technique, build in techniques:
        if slot == "order":
            files += ["shells/base.glsl", "shells/base_picture.glsl"]
        files += technique.includes
        files.append(glsl_file("shells", slot, technique.model_fields["kind"].default))
        declarations += technique_declarations(slot, technique)
        if slot == "shadow":
            files.append("shells/sun_visibility.glsl")
        if slot == "sampling":
            files.append("shells/gather.glsl")
            macros["SAMPLING_WHOLE"] = int(technique.whole)
        macros.update(build)
    version = max([version, *(technique.requires for _, technique, _ in techniques)])
    return assemble(
        [*files, *after],
        version=version,
        defines=macros,
        declarations="\n".join(declarations),
        body=body,
    )


def world_declarations() -> str:
    """Uniforms of camera, shell, texture and light."""
    models = (uniform_declarations(Voxels, "voxels"), uniform_declarations(Base, "base"))
    return "\n".join([CAMERA_DECLARATIONS, SKY_DECLARATIONS, WORLD_DECLARATIONS, CODED_DECLARATIONS, *models])


def technique_declarations(slot: str, technique: type[ShellsTechnique]) -> list[str]:
    """Samplers and uniforms of a technique."""
    samplers = [f"uniform {kind} {slot}_{name};" for name, kind in technique.textures.items()]
    return [*samplers, uniform_declarations(technique, slot), *technique.extra_declarations]
