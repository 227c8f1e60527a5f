"""The clouds' whole state document."""

from __future__ import annotations

from typing import Any, Literal

from renderer.clouds.planet import BuiltInLand, Clouds, Land, Layer, Planet, ProceduralClouds
from renderer.core.params import param
from renderer.core.registry import slot_union
from renderer.world.atmosphere import Atmosphere
from renderer.world.camera import Camera, Orbit
from renderer.world.state import SceneState, View
from renderer.world.sun import Sun, SunDirection

SLOTS = ("geometry", "phase", "scattering", "cloud_shadow", "basis", "bounce")
DEFAULTS = {
    "geometry": "sphere",
    "phase": "mie",
    "scattering": "adding_doubling",
    "cloud_shadow": "sun_ray",
    "basis": "object",
    "bounce": "fft",
}


AIR = Atmosphere(haze=4.0, ground_albedo=0.5)
"""The air over a cloudy land: light that it scatters often comes from ground and clouds together, which send back
about half. Over the land's own 0.15 skies above a deck were a fifth too dark against the paths' reference."""


def _slot(name: str, title: str, help_text: str) -> Any:
    return param({"kind": DEFAULTS[name]}, label=title, help=help_text, cost="host")


class CloudsState(SceneState):
    """State of the clouds: where one looks from, the sun, the planet, its layer of clouds, and one technique per
    slot."""

    scene: Literal["clouds"] = "clouds"
    camera: Camera = param(
        Orbit(target=(0.0, 0.0, 2300.0), distance=12000.0, azimuth=200.0, elevation=10.0, field_of_view=45.0),
        label="Camera",
        help="Where the picture is taken from.",
        cost="host",
    )
    sun: Sun = param(
        SunDirection(azimuth=110.0, elevation=14.0), label="Sun", help="Where the light comes from.", cost="host"
    )
    view: View = param(View(exposure=-1.0), label="View", help="Exposure, tone curve and background.", cost="host")
    time: float = param(
        0.0, label="Time", help="Clouds drift and change with it.", unit="s", cost="host", ge=0, le=1e9, plays=60.0
    )
    layer: Layer = param(Layer(), label="Layer", help="The layer of clouds.")
    clouds: Clouds = param(ProceduralClouds(), label="Cloud map", help="Where the layer is thick.", cost="bake")
    planet: Planet = param(Planet(), label="Planet", help="The sphere, the site and its ground.")
    land: Land = param(BuiltInLand(), label="Land", help="The land round the site.", cost="bake")
    air: Atmosphere = param(AIR, label="Air", help="What sun and sky shine through.", cost="bake")
    geometry: slot_union("clouds", "geometry") = _slot(  # type: ignore[valid-type]
        "geometry", "Geometry", "How long a ray runs through the layer."
    )
    phase: slot_union("clouds", "phase") = _slot(  # type: ignore[valid-type]
        "phase", "Phase function", "Where a droplet sends light."
    )
    scattering: slot_union("clouds", "scattering") = _slot(  # type: ignore[valid-type]
        "scattering", "Scattering", "What the layer makes of the light."
    )
    cloud_shadow: slot_union("clouds", "cloud_shadow") = _slot(  # type: ignore[valid-type]
        "cloud_shadow", "Cloud shadow", "What the layer leaves to the ground."
    )
    basis: slot_union("clouds", "basis") = _slot(  # type: ignore[valid-type]
        "basis", "Basis", "Functions by which transfer matrices describe bounced light."
    )
    bounce: slot_union("clouds", "bounce") = _slot(  # type: ignore[valid-type]
        "bounce", "Bounce", "Light that goes between ground and clouds."
    )

    def techniques(self) -> dict[str, Any]:
        """The chosen technique of each slot."""
        return {slot: getattr(self, slot) for slot in SLOTS}
