"""As many samples as a segment crosses voxels."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.technique import ShellsTechnique


class Adaptive(ShellsTechnique):
    """Steps of a voxel of the level that is read."""

    title: ClassVar[str] = "Adaptive"
    caption: ClassVar[str] = "Steps as long as a voxel of the level that is read, lit where they hide much."
    paper: ClassVar[str] = "Levoy 1990, section 3"

    kind: Literal["adaptive"] = "adaptive"
    rate: float = param(0.7, label="Rate", help="Samples a voxel.", ge=0.05, le=64)
    jitter: float = param(
        1.0, label="Jitter", help="By how much of a step samples move between pictures.", unit="ratio", ge=0, le=1
    )
    lit: float = param(
        0.5, label="Lit", help="Opacity of the samples that share one look at the light.", unit="ratio", ge=0, le=1
    )
    most: int = param(
        16, label="Most samples", help="Of one segment.", cost="build", unit="count", ge=1, le=4096
    )
