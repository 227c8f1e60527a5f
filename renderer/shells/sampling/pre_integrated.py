"""Closed forms between samples."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.technique import ShellsTechnique


class PreIntegrated(ShellsTechnique):
    """Between samples, extinction and light change steadily, and what is seen of them is a closed form."""

    title: ClassVar[str] = "Pre-integrated"
    caption: ClassVar[str] = "Extinction and light change steadily between samples, each of which is lit."
    paper: ClassVar[str] = "Engel, Kraus & Ertl 2001, section 3"

    kind: Literal["pre_integrated"] = "pre_integrated"
    rate: float = param(1.0, label="Rate", help="Samples a voxel.", ge=0.05, le=64)
    most: int = param(
        256, label="Most samples", help="Of one segment.", cost="build", unit="count", ge=1, le=4096
    )
