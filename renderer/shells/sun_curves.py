"""Maps from the sun that keep how much of it is left at each depth."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar

from renderer.core.params import param
from renderer.core.technique import Bake
from renderer.gl.source import Source
from renderer.shells.program import chosen, composed, variant_of
from renderer.shells.technique import ShadowTechnique
from renderer.shells.texture.sources import texture_bake
from renderer.shells.texture.strides import strides_bake

if TYPE_CHECKING:
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

MAP_DECLARATIONS = (
    "uniform vec3 shadow_origin;  // of the map's rays: corner, m",
    "uniform vec3 shadow_across;  // texels/m",
    "uniform vec3 shadow_down;",
    "uniform vec3 shadow_along;   // unit vector away from the sun",
    "uniform float shadow_texel;  // m",
    "uniform float shadow_side;   // texels",
)

PASS_DECLARATIONS = """uniform float shadow_texel; // m
uniform float shadow_side;  // texels"""

BODY = """layout(location = 0) out vec4 near;
layout(location = 1) out vec4 far;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Ray ray = pixel_ray(gl_FragCoord.xy);
    SunWay way = sun_way();
    bool met = false;
    int layer = 0;
    do {
        vec2 entry = entry_of(ray, pixel, layer);
        if (entry.y < 0.0) break;
        if (entry_behind(entry)) {
            sun_stop(way, entry.x, 1.0);
            break;
        }
        met = sun_walk(ray, int(entry.y), max(entry.x, 0.0), way);
        layer++;
    } while (layer < entry_layers && !met && way.depth < SUN_DARK);
    sun_settle(way);
    near = way.near;
    far = vec4(way.far, way.stop);
}"""


class SunCurves(ShadowTechnique):
    """A map from the sun, of how much is left of it at each depth: each texel keeps the distances at which that falls
    by a seventh, and by another, and how dark the gaps between are."""

    textures: ClassVar[dict[str, str]] = {"near": "sampler2D", "far": "sampler2D"}
    includes: ClassVar[tuple[str, ...]] = ("shells/sun_walk.glsl", "shells/deep_map.glsl")
    extra_declarations: ClassVar[tuple[str, ...]] = MAP_DECLARATIONS

    resolution: int = param(
        256, label="Resolution", help="Texels along a side of the map.", unit="px", cost="host", ge=16, le=4096
    )
    bias: float = param(
        1.0, label="Bias", help="How far from the opaque surface its own light still holds.", unit="px", ge=0, le=16
    )
    softness: float = param(0.5, label="Softness", help="Width over which texels are read.", unit="px", ge=0, le=16)

    def bakes(self, state: Any) -> list[Bake]:
        """How far rays may go within each voxel's matter."""
        return [strides_bake(texture_bake(state.texture), state.voxels.wrap)]

    def look(self, frame: Frame) -> tuple[dict[str, AnyTexture], dict[str, Any]]:
        """The map of this sun, unless it is still there."""
        return frame.from_sun("deep", self.resolution, {"near": (4, "f4"), "far": (4, "f4")}, pass_source)


def pass_source(state: ShellsState) -> Source:
    """The fragment stage that follows the sun's rays."""
    files = ("shells/sun_walk.glsl", "shells/entry.glsl")
    return composed(chosen(state, ("filter",)), variant_of(state), files, BODY, PASS_DECLARATIONS)
