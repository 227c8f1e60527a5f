"""The whole state document of the directional textures."""

from __future__ import annotations

from typing import Any, Literal

from renderer.core.params import Model, param
from renderer.core.registry import slot_union
from renderer.directional.brdf.materials import Material, Satin
from renderer.directional.cloud import Cloud
from renderer.directional.environments import Environment, SceneSky
from renderer.directional.lamp import Lamp
from renderer.directional.subject.knot import Knot
from renderer.directional.subjects import Subject
from renderer.directional.visibility import Visibility
from renderer.world.atmosphere import Atmosphere
from renderer.world.camera import Camera, Orbit
from renderer.world.state import SceneState
from renderer.world.sun import Sun, SunDirection

SLOTS = ("selection", "light", "self_shadow")
DEFAULTS = {"selection": "position_corrected", "light": "phong", "self_shadow": "bits"}


def _slot(name: str, title: str, help_text: str) -> Any:
    return param({"kind": DEFAULTS[name]}, label=title, help=help_text, cost="host")


class Hemispheres(Model):
    """How finely each point knows what hides the light from it."""

    directions: Literal[33, 129, 513, 2049] = param(
        513,
        label="Directions",
        help="Of light, that a point's hemisphere holds; the last for bits alone.",
        unit="count",
        cost="bake",
        source="Porquet 2005",
    )


class DirectionalState(SceneState):
    """State of the directional textures: what is seen, how finely, in which light, and one technique per slot."""

    scene: Literal["directional"] = "directional"
    camera: Camera = param(
        Orbit(target=(0.0, 0.0, 0.5), distance=4.8, azimuth=150.0, elevation=22.0, field_of_view=30.0),
        label="Camera",
        help="Where the picture is taken from.",
        cost="host",
    )
    sun: Sun = param(
        SunDirection(azimuth=205.0, elevation=40.0), label="Sun", help="Where the light comes from.", cost="host"
    )
    subject: Subject = param(Knot(), label="Subject", help="What the points lie on.", cost="bake")
    cloud: Cloud = param(Cloud(), label="Points", help="How finely the subject is sampled.")
    visibility: Visibility = param(Visibility(), label="Faces", help="What the faces of the box know of the points.")
    hemispheres: Hemispheres = param(
        Hemispheres(), label="Shadow hemispheres", help="How finely each point knows what hides the light from it."
    )
    material: Material = param(
        Satin(), label="Material", help="What the surface is of, where the light takes a measured one.", cost="bake"
    )
    environment: Environment = param(
        SceneSky(), label="Surroundings", help="What is mirrored, where the light takes surroundings."
    )
    lamp: Lamp = param(Lamp(), label="Lamp", help="A point of light beside the subject.")
    air: Atmosphere = param(Atmosphere(), label="Air", help="What sun and sky shine through.", cost="bake")
    selection: slot_union("directional", "selection") = _slot(  # type: ignore[valid-type]
        "selection", "Selection", "Which points are seen."
    )
    light: slot_union("directional", "light") = _slot(  # type: ignore[valid-type]
        "light", "Light", "How points answer the light."
    )
    self_shadow: slot_union("directional", "self_shadow") = _slot(  # type: ignore[valid-type]
        "self_shadow", "Self-shadow", "What the subject hides from itself."
    )

    def techniques(self) -> dict[str, Any]:
        """The chosen technique of each slot."""
        return {slot: getattr(self, slot) for slot in SLOTS}

    def lighting(self) -> tuple[Any, ...]:
        """What the light of a point depends on, beside the sun and what was baked."""
        return (self.light, self.self_shadow, self.environment, self.lamp)


def coarse(state: DirectionalState) -> DirectionalState:
    """The state with fewer points, texels and directions: baked within seconds."""
    finest = {"texels": min(state.visibility.texels, 64), "directions": min(state.visibility.directions, 129)}
    fewer = {
        "cloud": state.cloud.model_copy(update={"points": min(state.cloud.points, 100_000)}),
        "visibility": state.visibility.model_copy(update=finest),
        "hemispheres": state.hemispheres.model_copy(update={"directions": min(state.hemispheres.directions, 129)}),
    }
    return state.model_copy(update=fewer)
