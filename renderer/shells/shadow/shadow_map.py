"""A shadow map: one depth a texel."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from renderer.core.params import param
from renderer.gl.source import Source
from renderer.shells.program import chosen, composed, variant_of
from renderer.shells.sun_curves import MAP_DECLARATIONS
from renderer.shells.technique import ShadowTechnique

if TYPE_CHECKING:
    from renderer.core.technique import Arrays
    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame
    from renderer.shells.state import ShellsState

DECLARATIONS = "uniform float shadow_most; // optical depth that counts as a surface"

BODY = """layout(location = 0) out float depth;
void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    Ray ray = pixel_ray(gl_FragCoord.xy);
    depth = 1.0e20;
    float passed = 0.0;
    bool met = false;
    int layer = 0;
    do {
        vec2 entry = entry_of(ray, pixel, layer);
        if (entry.y < 0.0) break;
        met = sun_first(ray, int(entry.y), max(entry.x, 0.0), shadow_most, passed, depth);
        layer++;
    } while (layer < entry_layers && !met);
}"""


class ShadowMap(ShadowTechnique):
    """The depth of the first place where opacity passes a threshold: the thesis' shadows."""

    title: ClassVar[str] = "Shadow map"
    caption: ClassVar[str] = "Seen from the sun, each texel keeps one depth: light before it, shadow behind; acne."
    paper: ClassVar[str] = "Dufort 2005, section 5.3.1"
    textures: ClassVar[dict[str, str]] = {"depth": "sampler2D"}
    extra_declarations: ClassVar[tuple[str, ...]] = MAP_DECLARATIONS

    kind: Literal["shadow_map"] = "shadow_map"
    resolution: int = param(
        512, label="Resolution", help="Texels along a side of the map.", unit="px", cost="host", ge=16, le=4096
    )
    opacity: float = param(
        0.5, label="Opacity", help="That counts as a surface.", unit="ratio", cost="host", ge=0.01, le=0.999
    )
    bias: float = param(1.5, label="Bias", help="How far behind the depth places are lit.", unit="px", ge=0, le=32)

    def constants(self, state: ShellsState, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """The optical depth of its opacity."""
        return {"shadow_most": -math.log1p(-self.opacity)}

    def look(self, frame: Frame) -> tuple[dict[str, AnyTexture], dict[str, Any]]:
        """The map of this sun, unless it is still there."""
        return frame.from_sun(f"first {self.opacity}", self.resolution, {"depth": (1, "f4")}, pass_source)


def pass_source(state: ShellsState) -> Source:
    """The fragment stage that follows the sun's rays to the first place that counts as a surface."""
    files = ("shells/sun_first.glsl", "shells/entry.glsl")
    return composed(chosen(state, ("filter",)), variant_of(state), files, BODY, DECLARATIONS)
