"""The passes that trace the layer along the rays of a picture and light what was traced, each part where it is seen.

What a pixel shows is traced as its depth, and the parts are drawn through tests of it: rasterisers pass over other
pixels long before the shader runs, where a branch of one would compute both sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from renderer.clouds.program import Variant, chosen_of, composed
from renderer.gl.parts import Where
from renderer.gl.source import Source

if TYPE_CHECKING:
    from renderer.clouds.state import CloudsState

SKY, GROUND, FAR, FAR_THROUGH, GROUND_THROUGH, SKY_THROUGH, CLOUD, ALL = 1, 2, 3, 4, 5, 6, 7, 16
"""What a pixel shows: the constants of shaders/clouds/frame.glsl; ALL is the depth 1."""

LAYER_BODY = """layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
layout(location = 2) out vec4 slopes;
layout(location = 3) out vec4 look;
layout(location = 4) out vec4 kept;
layout(location = 5) out vec4 past;
void main() {
    vec3 origin, direction;
    Path path = pixel_path(ivec2(gl_FragCoord.xy), origin, direction);
    float t = texelFetch(traced_ground, ivec2(gl_FragCoord.xy), 0).x;
    float stop = t >= 0.0 ? t : NEVER;
    vec4 legs = layer_legs(path, layer_base, layer_base + max(layer_thickness * layer_highest, 1.0), stop);
    // Below the base, and above the layer towards the sky, only the stretch behind the lowest point is there. Few rays
    // have both, and the second turn is skipped where none of their neighbours has.
    int leg = CAMERA_SIDE < 0 || legs.y <= 0.0 ? 1 : 0;
    Stretch near = Stretch(0.0, 0.0, 1.0, 1.0, vec2(0.0)), far = near;
    int turn = 0;
    do {
        vec2 nominal = leg == 0 ? legs.xy : legs.zw;
        Stretch one = stretch_of(path, origin, direction, leg, nominal, stop, pixel_angle);
        if (turn == 0) near = one; else far = one;
        turn++;
        leg++;
    } while (leg == 1 && legs.w > 0.0);
    float near_kept = stretch_keeps(near), far_kept = stretch_keeps(far);
    float cut = near.t > 0.0 ? near.t : AIR_UNDER ? stop : 0.0;
    Look found = look_along(path, origin, direction, stop, cut, near_kept);
    float overhead = cover_at(place_of(origin + t * direction), max(layer_base, pixel_angle * t)).thickness;
    float shown = shown_by(near_kept < 1.0, near_kept, far_kept < 1.0, t >= 0.0);
    float under = AIR_UNDER ? min(0.5 * cut, 3.0e4) : cut + 0.5 * min(stop - cut, 6.0e4);
    first = vec4(near.t, near.depth, near.thickness, near.mu_view);
    second = vec4(far.t, far.depth, far.mu_view, under);
    slopes = nearest_half(vec4(near.slope, near_kept, far_kept));
    look = found.air;
    kept = nearest_half(vec4(found.kept, shown));
    past = nearest_half(vec4(found.past, overhead));
    gl_FragDepth = shown / SHOWS_ALL;
}"""

LIT_HEAD = """layout(location = 0) out vec4 radiance;
Ray pixel_of_fragment() {
    Ray ray;
    ray.pixel = ivec2(gl_FragCoord.xy);
    camera_ray(picture_pixel(vec2(ray.pixel) + 0.5, picture_size) - 0.5 + pixel_offset, ray.origin, ray.direction);
#if AIR_TABLE == 1
    ray.path = path_near(ray.origin, camera_excess.x, ray.direction);
#else
    ray.path = path_of(ray.origin, ray.direction);
#endif
    return ray;
}
"""

PART_BODY = """void main() {
    radiance = %s_part(pixel_of_fragment());
}"""

LIT_SLOTS = ("geometry", "phase", "scattering", "cloud_shadow", "basis", "bounce")
"""Slots whose functions the picture calls, in the order in which they build on each other."""

FRAME_FILES = ("clouds/air_table.glsl", "clouds/air_look.glsl", "clouds/stretch.glsl")


@dataclass(frozen=True)
class Pass:
    """One part of the picture: its fragment stage and the pixels that have it."""

    source: Source
    where: tuple[Where, ...]


def layer_source(state: CloudsState, variant: Variant) -> Source:
    """The fragment stage that finds each ray's stretches inside the layer, and what is left behind; no sun is in it."""
    files = ("lib/half.glsl", *FRAME_FILES, "clouds/frame.glsl")
    return composed(chosen_of(state, ("geometry",)), variant, files, LAYER_BODY, ("FRAME_TRACED",))


def lit_passes(state: CloudsState, variant: Variant, disc: bool) -> list[Pass]:
    """The passes that light what was traced; their sum is the picture.

    Args:
        disc: whether the sun's disc is in the picture.
    """
    parts: dict[str, tuple[Where, ...]] = {
        "air": (("always", 0.0),) if variant.side < 0 else ((">", (CLOUD - 0.5) / ALL),),
        "cloud": (("<", (FAR + 0.5) / ALL),),
        "ground": (("==", GROUND / ALL), ("==", GROUND_THROUGH / ALL)),
    }
    if variant.side >= 0:
        parts["far"] = (("==", FAR / ALL), ("==", FAR_THROUGH / ALL))
    if disc:
        parts["disc"] = ((">", (CLOUD - 0.5) / ALL),)
    chosen = chosen_of(state, LIT_SLOTS)
    files = (*FRAME_FILES, "clouds/ground.glsl", "clouds/cloud.glsl", "clouds/frame.glsl")
    return [
        Pass(composed(chosen, variant, files, LIT_HEAD + PART_BODY % name, ("FRAME_LIT",)), where)
        for name, where in parts.items()
    ]
