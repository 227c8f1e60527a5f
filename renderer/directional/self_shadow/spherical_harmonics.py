"""Spherical harmonics fitted to the shadow hemisphere."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, Literal

from renderer.core.params import param
from renderer.core.technique import Arrays
from renderer.directional.self_shadowing import LAYOUT_DECLARATIONS, SelfShadowTechnique
from renderer.directional.technique import SHADOW_CODE

RANGES = """uniform vec2 self_shadow_ranges[
    SELF_SHADOW_SIZE == 5 ? 4 : (SELF_SHADOW_SIZE == 9 ? 9 : (SELF_SHADOW_SIZE == 17 ? 16 : 25))];"""
"""Least value and step of each coefficient."""


class SphericalHarmonics(SelfShadowTechnique):
    """The first orders of spherical harmonics, a byte a coefficient."""

    title: ClassVar[str] = "Spherical harmonics"
    caption: ClassVar[str] = "Smooth functions of the sphere, fitted to each point's hemisphere: soft and cheap."
    paper: ClassVar[str] = "Ramamoorthi & Hanrahan 2001; Sloan, Kautz & Snyder 2002, section 4"
    extra_declarations: ClassVar[tuple[str, ...]] = (*LAYOUT_DECLARATIONS, RANGES)

    kind: Literal["spherical_harmonics"] = "spherical_harmonics"
    size: Literal[5, 9, 17, 33] = param(
        9, label="Bytes", help="Of a point: orders 1, 2, 3 or 4.", unit="count", cost="build"
    )

    def constants(self, state: Any, baked: Mapping[str, Arrays]) -> dict[str, Any]:
        """The layout and the quantisers."""
        return {**super().constants(state, baked), "self_shadow_ranges": baked[SHADOW_CODE]["ranges"]}
