"""What of the directional textures is varied where they are held to their reference."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True)
class Setting:
    """What is varied.

    Attributes:
        texels, directions: of the faces. selection, code: techniques. shadow_directions: of a point's hemisphere.
        size: bytes of the code, where it has a choice; 0 for its own. blend: between directions of light; None for the
            code's own. points: of the cloud.
    """

    texels: int = 128
    directions: int = 513
    selection: str = "nearest"
    code: str = "bits"
    shadow_directions: int = 513
    size: int = 0
    blend: bool | None = None
    points: int = 400_000

    def sets(self) -> dict[str, Any]:
        """What differs from a preset, by path."""
        code: dict[str, Any] = {"kind": self.code} | ({"size": self.size} if self.size else {})
        code |= {} if self.blend is None else {"blend": self.blend}
        return {
            "cloud.points": self.points,
            "visibility.texels": self.texels,
            "visibility.directions": self.directions,
            "hemispheres.directions": self.shadow_directions,
            "selection": {"kind": self.selection},
            "self_shadow": code,
        }


SELECTIONS = ("nearest", "blended", "position_corrected")
FACES = tuple(
    Setting(texels, directions, selection)
    for directions in (129, 513, 2049)
    for texels in (64, 128, 256)
    for selection in SELECTIONS
)
"""What the faces know, and how a point is chosen."""

OUTLINES = tuple(
    replace(setting, code="none", shadow_directions=33, points=1_500_000 if setting.texels == 256 else 400_000)
    for setting in (*FACES[-1:], *FACES[:-1])
)
"""The same for silhouettes, which no shadow changes; the one that most is asked of first."""

BASE = Setting(128, 513, "position_corrected")

BEST = Setting(256, 2049, "position_corrected", shadow_directions=2049)

CHIEF = (BASE, BEST)
"""What is taken as it comes, and what errs least: from every side in every sun."""

CODED = replace(BASE, points=100_000)

CODES = (
    *(replace(CODED, code=code) for code in ("none", "bits", "exact_harmonics", "chosen")),
    *(
        replace(CODED, code=code, size=size)
        for code, sizes in (
            ("harmonics", (5, 9, 17, 33)),
            ("spherical_harmonics", (5, 9, 17, 33)),
            ("horizon_ring", (5, 9, 17)),
            ("codebook", (5, 9)),
        )
        for size in sizes
    ),
    *(
        replace(CODED, shadow_directions=count, blend=blend)
        for count in (33, 129, 513, 2049)
        for blend in (False, True)
    ),
)
"""What a point knows of its shadow."""
