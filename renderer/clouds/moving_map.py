"""The thickness map of a moment, drawn: time that runs asks for one a frame."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import moderngl
import numpy as np

from renderer.clouds.cloud_map import EDGE, SWELLS, threshold_of, turned
from renderer.core.technique import Arrays
from renderer.gl.context import GL
from renderer.gl.program import AnyTexture
from renderer.gl.source import Source, assemble
from renderer.gl.targets import run_fullscreen

DECLARATIONS = """uniform sampler2D moment_fields;
uniform sampler2D moment_heights;
uniform vec2 moment_turn;
uniform float moment_threshold;
uniform float moment_variation;
uniform float moment_texel; // m"""

HEIGHTS = """layout(location = 0) out float height;
void main() {
    height = moment_thickness(texelFetch(moment_fields, ivec2(gl_FragCoord.xy), 0).rg);
}"""

SLOPES = """layout(location = 0) out vec4 made;
void main() {
    made = nearest_half(moment_with_slopes(moment_heights, ivec2(gl_FragCoord.xy)));
}"""


def field_texture(gl: GL, fields: Arrays) -> dict[str, AnyTexture]:
    """The two fields of a procedural map as one texture."""
    return {"moment_fields": gl.texture2d(np.ascontiguousarray(np.moveaxis(fields["fields"], 0, -1)), "nearest")}


def moving_map(
    gl: GL, clouds: Any, fields: Mapping[str, AnyTexture], side: float, time: float
) -> dict[str, AnyTexture]:
    """What `textures.moment_map` gives, of a procedural map whose fields are there as a texture.

    Args:
        clouds: the document's map. fields: of `field_texture`. side: of the map, m. time: s.
    """
    size = fields["moment_fields"].size
    values = {
        "moment_turn": turned(clouds, time),
        "moment_threshold": threshold_of(clouds),
        "moment_variation": clouds.variation,
        "moment_texel": side / size[0],
    }
    heights = gl.ctx.texture(size, 1, dtype="f4")
    made = gl.ctx.texture(size, 4, dtype="f2")
    for target, body, given in ((heights, HEIGHTS, fields), (made, SLOPES, {"moment_heights": heights})):
        framebuffer = gl.ctx.framebuffer([target])
        framebuffer.use()
        run_fullscreen(gl, _stage(body), given, values)
        framebuffer.release()
    heights.release()
    made.build_mipmaps()  # sides are powers of two: the driver's levels are means
    made.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
    return {"cloud_map": made}


@functools.cache
def _stage(body: str) -> Source:
    defines = {"EDGE": repr(EDGE), "SWELLS": repr(SWELLS)}
    return assemble(["lib/half.glsl", "clouds/moment.glsl"], defines=defines, declarations=DECLARATIONS, body=body)
