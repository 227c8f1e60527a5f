"""What a case of the failure catalogue is: where a technique fails, by how much, why, and what survives there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

Symptom = Literal["flicker", "sway", "error", "stains"]
"""What is measured, against exact shadows under the picture's own light; of a light technique, against all the truth.

While `sweep` moves, the `flicker`, or the `sway`: by how much the picture's brightness over the truth's differs within
the sweep, as a share of its mean. Of the still picture the `error`, its relative RMSE, or the `stains`, the share of
its pixels that are off by more than half of the mean."""


@dataclass(frozen=True)
class Failure:
    """One named failure.

    Attributes:
        name: of the case, as a path's part. title: for people.
        slot: whose techniques are compared.
        failing, surviving: kind and parameters of each, as `kind:name=value:..`.
        preset: of the scene. sets: what else differs from it, by path.
        symptom: what is measured. sweep: what moves, where something does.
        threshold: the symptom is a failure above it; whoever survives stays below.
        measured: the symptom of the failing and of the surviving one when the case was written.
        cause: one sentence.
        width: of the pictures, pixels. steps: of the sweep. stride: how many of a sweep's steps are taken at once.
    """

    name: str
    title: str
    slot: str
    failing: str
    surviving: str
    preset: str
    symptom: Symptom
    threshold: float
    measured: tuple[float, float]
    cause: str
    sweep: str = ""
    sets: Mapping[str, Any] = field(default_factory=dict)
    width: int = 48
    steps: int = 4
    stride: float = 1.0
