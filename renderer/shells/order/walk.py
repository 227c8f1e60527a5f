"""Order by walking from tetrahedron to tetrahedron."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Literal

from renderer.core.params import param
from renderer.gl.layers import Kind
from renderer.shells.first_look import rays_of_some
from renderer.shells.program import compose_source, spread_source, walk_source
from renderer.shells.technique import OrderTechnique
from renderer.shells.traced import lit_along_traces

if TYPE_CHECKING:
    import moderngl

    from renderer.gl.program import AnyTexture
    from renderer.shells.frame import Frame


class Walk(OrderTechnique):
    """Each ray goes through the faces that tetrahedra share; its order is exact, and cycles do no harm."""

    title: ClassVar[str] = "Walk"
    caption: ClassVar[str] = "Each ray goes from cell to cell through the faces they share: exact, without sorting."
    paper: ClassVar[str] = "Garrity 1990, section 3"

    kind: Literal["walk"] = "walk"
    steps: int = param(
        1024, label="Most cells", help="That a ray crosses in one go.", cost="build", unit="count", ge=16, le=65536
    )

    def picture(self, frame: Frame) -> tuple[Any, dict[str, AnyTexture], dict[str, Any]]:
        """Find where rays come in, and walk; what is gathered goes before the background."""
        inside = frame.values["start_tet"] >= 0
        sampling, rays = frame.state.sampling.first_sample()
        if inside and rays == 2:
            rays = 1  # rays are followed everywhere then, and slanting rows would have as many again beside the picture
        if min(frame.size) == 1:
            rays = 4  # a ray of every second pixel has no neighbours across
        if frame.sample == 0 and rays < 4:
            gathered, more = rays_of_some(frame, frame.state.model_copy(update={"sampling": sampling}), rays, inside)
            source, values = spread_source(frame.state, rays), {**frame.values, **more}
        else:
            source, gathered, values = compose_source(frame.state), _gathered(frame, inside), frame.values
        return source, {**_with_things(frame).textures, "gathered": gathered}, values


def _gathered(frame: Frame, inside: bool) -> moderngl.Texture:
    layers = _with_things(frame).entries()
    if frame.state.sampling.whole:
        return lit_along_traces(frame, layers, inside)
    kinds: tuple[Kind, ...] = ((4, frame.state.accumulation.dtype),)
    source = walk_source(frame.state, inside)
    return layers.draw(kinds, 0.0, source, frame.textures, frame.values, everywhere=inside)[0]


def _with_things(frame: Frame) -> Frame:
    """The frame, once its camera has looked at other meshes."""
    if frame.things is not None and "thing_seen" not in frame.textures:
        frame.textures["thing_seen"] = frame.things.seen(frame)
    return frame
