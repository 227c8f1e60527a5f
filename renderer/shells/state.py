"""The shells' whole state document."""

from __future__ import annotations

from typing import Any, Literal

from renderer.core.params import param
from renderer.core.registry import slot_union
from renderer.shells.animation import Motion, Still
from renderer.shells.base_picture import BasePicture, NoPicture
from renderer.shells.course import Course
from renderer.shells.extrusion import Extrusion
from renderer.shells.surfaces import Sphere, Surface
from renderer.shells.texture.fur import Fur
from renderer.shells.texture.sources import Texture
from renderer.shells.things import Things
from renderer.shells.voxels import Base, Voxels
from renderer.world.atmosphere import Atmosphere
from renderer.world.camera import Camera, Orbit
from renderer.world.state import SceneState
from renderer.world.sun import Sun, SunDirection

SLOTS = ("order", "sampling", "light", "shadow", "filter", "accumulation")
DEFAULTS = {
    "order": "walk",
    "sampling": "quantiles",
    "light": "lambert",
    "shadow": "deep_shadow_map",
    "filter": "mipmap",
    "accumulation": "single",
}


def _slot(name: str, title: str, help_text: str) -> Any:
    return param({"kind": DEFAULTS[name]}, label=title, help=help_text, cost="host")


class ShellsState(SceneState):
    """State of the shells: a surface, the shell over it, what fills it, and one technique per slot."""

    scene: Literal["shells"] = "shells"
    camera: Camera = param(
        Orbit(target=(0.0, 0.0, 0.0), distance=3.2, azimuth=150.0, elevation=20.0, field_of_view=35.0),
        label="Camera",
        help="Where the picture is taken from.",
        cost="host",
    )
    sun: Sun = param(
        SunDirection(azimuth=205.0, elevation=40.0), label="Sun", help="Where the light comes from.", cost="host"
    )
    time: float = param(
        0.0, label="Time", help="Surfaces and textures move with it.", unit="s", cost="host", ge=0, le=1e9, plays=1.0
    )
    surface: Surface = param(Sphere(), label="Surface", help="What the shell stands on.", cost="bake")
    extrusion: Extrusion = param(Extrusion(), label="Shell", help="How the shell rises from the surface.")
    motion: Motion = param(Still(), label="Motion", help="How the surface moves as time runs.")
    texture: Texture = param(Fur(), label="Texture", help="What fills the shell.", cost="bake")
    course: Course = param(
        Course(), label="Key frames", help="What changes as time runs, and to what.", cost="host"
    )
    voxels: Voxels = param(Voxels(), label="Voxels", help="How the texture is read.")
    base: Base = param(Base(), label="Base", help="The surface under the shell.")
    picture: BasePicture = param(
        NoPicture(), label="Picture on the base", help="What is painted on the surface under the shell."
    )
    things: Things = param(Things(), label="Other things", help="Opaque meshes that stand beside the shell.")
    air: Atmosphere = param(Atmosphere(), label="Air", help="What sun and sky shine through.", cost="bake")
    order: slot_union("shells", "order") = _slot(  # type: ignore[valid-type]
        "order", "Order", "In which order the segments of a ray are put together."
    )
    sampling: slot_union("shells", "sampling") = _slot(  # type: ignore[valid-type]
        "sampling", "Sampling", "How a segment reads the texture."
    )
    light: slot_union("shells", "light") = _slot(  # type: ignore[valid-type]
        "light", "Light", "How matter answers the light."
    )
    shadow: slot_union("shells", "shadow") = _slot(  # type: ignore[valid-type]
        "shadow", "Shadow", "What the shell leaves of the sun."
    )
    filter: slot_union("shells", "filter") = _slot(  # type: ignore[valid-type]
        "filter", "Filter", "Which level of the texture is read."
    )
    accumulation: slot_union("shells", "accumulation") = _slot(  # type: ignore[valid-type]
        "accumulation", "Accumulation", "How precisely colours are put together."
    )

    def techniques(self) -> dict[str, Any]:
        """The chosen technique of each slot."""
        return {slot: getattr(self, slot) for slot in SLOTS}
