"""A map from the sun that keeps how much of it is left at each depth."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.sun_curves import SunCurves


class DeepShadowMap(SunCurves):
    """What is left of the sun, from the map, and close to the lit place from the matter itself."""

    title: ClassVar[str] = "Deep shadow map"
    caption: ClassVar[str] = "Seen from the sun, each texel keeps how much light is left at each depth."
    paper: ClassVar[str] = "Lokovic & Veach 2000, section 3"

    kind: Literal["deep_shadow_map"] = "deep_shadow_map"
    close: int = param(
        3, label="Close samples", help="Of matter between a place and where the map is asked.", cost="build",
        unit="count", ge=0, le=32,
    )  # fmt: skip
    reach: float = param(1.5, label="Reach", help="How far from a place that is.", unit="px", ge=0, le=16)
