"""Rays followed once, and lit as often as the light changes: where a ray is lit, kept from one pass to the next."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from renderer.gl.layers import Kind
from renderer.gl.source import Source
from renderer.shells.program import LIT_SLOTS, chosen, composed, variant_of, walk_loop

if TYPE_CHECKING:
    import moderngl

    from renderer.shells.entries import Layers
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

TRACE_BODY = """%s
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Ray ray = pixel_ray(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    gather_begin();
%s
    sampling_settle();
    float kept[%d];
    for (int k = 0; k < SAMPLING_PLACES; k++) {
        kept[2 * k] = sampling_at[k];
        kept[2 * k + 1] = sampling_tet[k];
    }
    kept[2 * SAMPLING_PLACES] = sum.a;
    kept[2 * SAMPLING_PLACES + 1] = base_hit.x;
    kept[2 * SAMPLING_PLACES + 2] = base_hit.y;
%s
}"""

LIGHT_BODY = """%s
layout(location = 0) out vec4 gathered;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Ray ray = pixel_ray(gl_FragCoord.xy);
    float kept[%d];
%s
    vec4 sum = vec4(0.0, 0.0, 0.0, kept[2 * SAMPLING_PLACES]);
    gather_begin();
    sampling_opacity = sum.a;
    for (int k = 0; k < SAMPLING_PLACES; k++) {
        sampling_at[k] = kept[2 * k];
        sampling_tet[k] = kept[2 * k + 1];
    }
    sampling_light_all(ray, sum);
#if BASE_OPAQUE == 1
    int met = int(kept[2 * SAMPLING_PLACES + 2]);
    if (met >= 0) {
        float at = kept[2 * SAMPLING_PLACES + 1];
        sum += (1.0 - sum.a) * vec4(base_radiance(ray, met / 4, met %% 4, at), 1.0);
    }
#endif
    gathered = buffer_of(sum);
}"""


def lit_along_traces(frame: Frame, layers: Layers, inside: bool) -> moderngl.Texture:
    """Light and opacity of the camera's rays; those that were followed before are lit alone.

    Args:
        layers: where they come in. inside: whether the camera is within a cell.
    """
    state, count = frame.state, targets(frame.state)
    shows = (
        "trace", frame.texture_key, frame.values["sample_shift"], inside, variant_of(state),
        frame.things.key if frame.things is not None else None,
        *(getattr(state, part) for part in ("voxels", "filter", "sampling", "order", "accumulation")),
    )  # fmt: skip
    kinds: tuple[Kind, ...] = ((4, "f4"),) * count
    if frame.things is not None and "thing_seen" not in frame.textures and not layers.holds(kinds, shows):
        frame.textures["thing_seen"] = frame.things.met(frame)
    traces = layers.draw(kinds, None, trace_source(state, inside), frame.textures, frame.values, shows, inside)
    textures = {**frame.textures, **{f"traced_{n}": trace for n, trace in enumerate(traces)}}
    last: tuple[Kind, ...] = ((4, state.accumulation.dtype),)
    return layers.draw(last, 0.0, light_source(state), textures, frame.values, everywhere=inside)[0]


def targets(state: ShellsState) -> int:
    """Textures that hold a ray's places: distance and cell of each, the opacity, and where it met the surface."""
    return math.ceil((2 * state.sampling.places + 3) / 4)


def trace_source(state: ShellsState, inside: bool) -> Source:
    """The fragment stage that follows rays."""
    count = targets(state)
    outs = "\n".join(f"layout(location = {n}) out vec4 traced_{n};" for n in range(count))
    kept = [f"kept[{k}]" for k in range(4 * count)]
    written = "\n".join(f"    traced_{n} = vec4({', '.join(kept[4 * n:4 * n + 4])});" for n in range(count))
    return _stage(state, TRACE_BODY % (outs, walk_loop(inside), 4 * count, written), "#define TRACED 1")


def light_source(state: ShellsState) -> Source:
    """The fragment stage that lights them."""
    count = targets(state)
    ins = "\n".join(f"uniform sampler2D traced_{n};" for n in range(count))
    read = "\n".join(
        f"    {{ vec4 held = texelFetch(traced_{n}, pixel, 0); "
        + " ".join(f"kept[{4 * n + k}] = held[{k}];" for k in range(4)) + " }"
        for n in range(count)
    )  # fmt: skip
    return _stage(state, LIGHT_BODY % (ins, 4 * count, read), "")


def _stage(state: ShellsState, body: str, more: str) -> Source:
    return composed(chosen(state, LIT_SLOTS), variant_of(state), ("shells/entry.glsl",), body, more)
