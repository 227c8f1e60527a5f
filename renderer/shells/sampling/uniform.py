"""The same number of samples in every segment."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.shells.technique import ShellsTechnique


class Uniform(ShellsTechnique):
    """N samples, evenly spaced, however long the segment."""

    title: ClassVar[str] = "Uniform"
    caption: ClassVar[str] = "The same number of samples in every segment: what is smaller than a step is missed."
    paper: ClassVar[str] = "Dufort 2005, section 5.1.2"

    kind: Literal["uniform"] = "uniform"
    samples: float = param(
        10.0, label="Samples", help="Of each segment.", unit="count", ge=1, le=512, step=1,
        source="Dufort 2005, table 6.1",
    )
    correction: bool = param(
        True,
        label="Opacity correction",
        help="Whether a sample's opacity follows from the length of its step.",
        cost="build",
        source="errata 002-4",
    )
