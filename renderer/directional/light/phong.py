"""Phong's model: ambient, diffuse and specular light of sun and lamp."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from renderer.core.params import param
from renderer.core.technique import Arrays
from renderer.directional.lamp import LAMP_DECLARATIONS, lamp_values
from renderer.directional.technique import DirectionalTechnique


class Phong(DirectionalTechnique):
    """Points reflect as plastic does: matt in their own colour, with an even highlight."""

    title: ClassVar[str] = "Phong"
    caption: ClassVar[str] = "Ambient, diffuse and a normalised highlight, for the sun and for a lamp near by."
    paper: ClassVar[str] = "Phong 1975; Lafortune & Willems 1994"
    includes: ClassVar[tuple[str, ...]] = ("directional/phong_lobe.glsl", "directional/sources.glsl")
    extra_declarations: ClassVar[tuple[str, ...]] = (LAMP_DECLARATIONS,)

    kind: Literal["phong"] = "phong"
    ambient: float = param(1.0, label="Ambient", help="Share of the sky's light.", unit="ratio", ge=0, le=1)
    diffuse: float = param(
        0.9, label="Diffuse", help="Share of the light that is returned to all sides.", unit="ratio", ge=0, le=1
    )
    specular: float = param(
        0.1, label="Specular", help="Share of the light that the highlight has.", unit="ratio", ge=0, le=1
    )
    shininess: float = param(
        40.0, label="Shininess", help="Exponent of the highlight.", ge=1, le=2000, source="Phong 1975"
    )

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """Where the lamp is."""
        return lamp_values(state.lamp, baked)
