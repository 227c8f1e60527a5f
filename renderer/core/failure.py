"""What a case of the failure catalogue is: where a technique fails, by how much, why, and what survives there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

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


Part = Literal["failing", "surviving", "truth"]


@dataclass(frozen=True)
class ChartedFailure:
    """One named failure whose symptom is a number that no picture has: it shows a chart.

    Attributes:
        name, title, threshold, measured, cause: as of `Failure`.
        failing, surviving: either technique, in words.
        symptom: what is measured, in words; a share.
        measure: function that measures both, as `module:name`; it answers `Charted`.
    """

    name: str
    title: str
    failing: str
    surviving: str
    symptom: str
    threshold: float
    measured: tuple[float, float]
    cause: str
    measure: str


@dataclass(frozen=True)
class Curve:
    """One line of a chart: whose it is, its points (N,), and what it says instead of the technique's words."""

    part: Part
    x: np.ndarray
    y: np.ndarray
    label: str = ""


@dataclass(frozen=True)
class Charted:
    """What a charted failure measures today.

    Attributes:
        failing, surviving: the symptom of either.
        curves: of the chart. x, y: its axes in words. log: axes with a logarithmic scale, "", "x", "y" or "xy".
    """

    failing: float
    surviving: float
    curves: tuple[Curve, ...]
    x: str
    y: str
    log: Literal["", "x", "y", "xy"] = ""
