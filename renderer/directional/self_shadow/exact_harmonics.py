"""All harmonics, in full precision."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.directional.self_shadowing import SelfShadowTechnique


class ExactHarmonics(SelfShadowTechnique):
    """Every harmonic of a point's hemisphere: its directions exactly, and waves between them."""

    title: ClassVar[str] = "All harmonics"
    caption: ClassVar[str] = "The whole transform in full precision: exact at its directions, ringing between them."
    paper: ClassVar[str] = "Porquet 2005, section on self-shadowing by hemispheres"

    kind: Literal["exact_harmonics"] = "exact_harmonics"
