"""One stand from near and from far: whether its brightness stays the reference's at every distance."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from renderer.comparing import converged, truth
from renderer.core.channel import Progress
from renderer.core.errors import InputError
from renderer.study.metrics import relative_rmse
from renderer.truth import Judge
from renderer.world.camera import Orbit
from renderer.world.state import SceneState

if TYPE_CHECKING:
    from renderer.session import Session

DISTANCES = (2.0, 20.0, 100.0, 500.0, 2500.0, 10000.0)
"""From a leaf at arm's length to the other side of the valley [m]."""

LINES, FIELD_OF_VIEW = 512, 40.0
"""Lines and vertical angle [deg] of the picture that is measured: a pixel is 1.4 mm wide a metre away."""

FINE = 0.4
"""Width of a pixel [m] up to which nothing is filtered: nearer pictures take such pixels, to see more of the stand."""

TELL = Callable[[float, str], None]


@dataclass(frozen=True)
class Line:
    """What one distance gave.

    Attributes:
        distance: from the camera to the stand [m]. footprint: width of a pixel there in a picture of LINES [m].
        mean, reference: mean radiance over the pixels and channels [W m-2 sr-1]. ratio: of the two.
        standard_error: of the reference's mean, relative, at most. relative_rmse: of the picture.
    """

    distance: float
    footprint: float
    mean: float
    reference: float
    ratio: float
    standard_error: float
    relative_rmse: float


def window(state: SceneState, distance: float, size: int) -> SceneState:
    """The state seen from a distance: `size` lines in the middle of a picture of LINES, with pixels as wide as there;
    from near, with pixels of FINE, as far as they fit in its field of view.

    Raises:
        InputError: its camera has no target to stay with.
    """
    if not isinstance(state.camera, Orbit):
        raise InputError("camera.kind", "a stand is seen from several distances by an orbit around it", "orbit")
    whole = math.tan(math.radians(FIELD_OF_VIEW) / 2)
    half = max(whole * size / LINES, min(whole, FINE * size / 2 / distance))
    camera = state.camera.model_copy(update={"distance": distance, "field_of_view": 2 * math.degrees(math.atan(half))})
    return state.model_copy(update={"camera": camera})


def measure(
    session: Session,
    state: SceneState,
    distances: Sequence[float] = DISTANCES,
    size: int = 48,
    judge: Judge = "combination",
    tell: TELL | None = None,
) -> list[Line]:
    """Mean radiance of the stand around the camera's target against the reference, from each distance; blocks.

    Args:
        session: draws, bakes and caches. state: whose camera orbits the stand.
        distances: [m]. size: pixels a side. judge: as `renderer.truth.Judge`. tell: told the share done, in words.

    Raises:
        InputError: the camera orbits nothing, or a distance shows nothing of the scene.
    """
    lines = []
    for number, distance in enumerate(distances):

        def inner(progress: Progress, at: int = number, metres: float = distance) -> None:
            if tell is not None:
                tell((at + 0.95 * progress.fraction) / len(distances), f"{metres:g} m: {progress.words}")

        seen = window(state, distance, size)
        found = truth(session, seen, size, size, judge, inner)
        picture = converged(session, seen, size, size).linear[..., :3]
        mean = float(found.linear[..., :3].mean())
        if mean <= 0:
            raise InputError("distances", f"{distance:g} m shows nothing but background")
        lines.append(
            Line(
                distance,
                2 * distance * math.tan(math.radians(FIELD_OF_VIEW) / 2) / LINES,
                float(picture.mean()),
                mean,
                float(picture.mean()) / mean,
                found.standard_error / size,
                float(relative_rmse(picture, np.asarray(found.linear[..., :3]))),
            )
        )
    return lines


def table(lines: Sequence[Line]) -> str:
    """The lines as a Markdown table."""
    rows = [
        f"| {line.distance:g} | {line.footprint:.3g} | {line.mean:.4g} | {line.reference:.4g} | {line.ratio:.3f} "
        f"| {line.standard_error:.4f} | {line.relative_rmse:.3f} |"
        for line in lines
    ]
    head = "| distance, m | pixel, m | mean | reference | ratio | standard error | relative RMSE |"
    return "\n".join([head, "| ---: | ---: | ---: | ---: | ---: | ---: | ---: |", *rows])
