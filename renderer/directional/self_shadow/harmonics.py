"""Principal harmonics, quantised: the thesis' nine bytes."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.directional.self_shadowing import SelfShadowTechnique


class Harmonics(SelfShadowTechnique):
    """The largest harmonics of a point's hemisphere, each by number, amplitude and phase; a cosine each to read."""

    title: ClassVar[str] = "Principal harmonics"
    caption: ClassVar[str] = "The few largest harmonics of each point's shadow hemisphere, quantised: a cosine each."
    paper: ClassVar[str] = "Porquet 2005, section on self-shadowing by hemispheres, and erratum 003-5"

    kind: Literal["harmonics"] = "harmonics"
    size: Literal[5, 9, 17, 33] = param(
        9, label="Bytes", help="Of a point: 2, 4, 8 or 16 harmonics.", unit="count", cost="build", source="Porquet 2005"
    )
