"""One stand from near and from far: whether its brightness stays the reference's, and whether it pops or shimmers on
the way."""

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
from renderer.study.stability import flicker
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

STRETCHES = (2.0, 20.0, 100.0, 300.0, 425.0, 600.0, 850.0, 1200.0, 1700.0, 2400.0, 4800.0, 10000.0)
"""Distances [m] at which the camera steps back: near, and about those at which a pixel of LINES becomes one, two, four
voxels wide, with and without half a level of bias, where a coarser level of the pattern takes over."""

STEP, STEPS = 0.01, 4
"""Share of its distance by which the camera steps back, and how often, around each of those distances."""

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


@dataclass(frozen=True)
class Stretch:
    """A few steps back from one distance.

    Attributes:
        distance: about which the camera steps [m]. footprint: width of a pixel there [m].
        pop: largest change of the picture's mean radiance in a step beyond the reference's, over the reference's mean.
        jump: the same of the pixels, root mean square: the worst step's flicker of converged pictures.
        truth: what the reference's pixels change by, root mean square.
        shimmer: flicker of single interactive frames. floor: that of the reference with one ray a pixel.
    """

    distance: float
    footprint: float
    pop: float
    jump: float
    truth: float
    shimmer: float
    floor: float


def window(state: SceneState, distance: float, size: int, fine: float = FINE) -> SceneState:
    """The state seen from a distance: `size` lines in the middle of a picture of LINES, with pixels as wide as there;
    from near, with pixels of `fine` [m], as far as they fit in its field of view.

    Raises:
        InputError: its camera has no target to stay with.
    """
    if not isinstance(state.camera, Orbit):
        raise InputError("camera.kind", "a stand is seen from several distances by an orbit around it", "orbit")
    whole = math.tan(math.radians(FIELD_OF_VIEW) / 2)
    half = max(whole * size / LINES, min(whole, fine * size / 2 / distance))
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
                footprint(distance),
                float(picture.mean()),
                mean,
                float(picture.mean()) / mean,
                found.standard_error / size,
                float(relative_rmse(picture, np.asarray(found.linear[..., :3]))),
            )
        )
    return lines


def footprint(distance: float) -> float:
    """Width of a pixel at a distance in a picture of LINES [m]."""
    return 2 * distance * math.tan(math.radians(FIELD_OF_VIEW) / 2) / LINES


def dolly(
    session: Session,
    state: SceneState,
    distances: Sequence[float] = STRETCHES,
    size: int = 48,
    judge: Judge = "combination",
    tell: TELL | None = None,
) -> list[Stretch]:
    """What pops and shimmers while the camera steps back from the stand, with a picture's own pixels; blocks.

    Args:
        session, state, size, judge, tell: as of `measure`. distances: about which it steps [m].

    Raises:
        InputError: the camera orbits nothing, or a distance shows nothing of the scene.
    """
    found = []
    for number, distance in enumerate(distances):
        places = [distance * (1 + STEP) ** (turn - STEPS / 2) for turn in range(STEPS + 1)]
        truths, pictures = [], []
        for turn, place in enumerate(places):
            seen = window(state, place, size, 0.0)

            def inner(progress: Progress, at: float = number + turn / (STEPS + 1), metres: float = place) -> None:
                if tell is not None:
                    share = (at + 0.9 * progress.fraction / (STEPS + 1)) / len(distances)
                    tell(share, f"{metres:.4g} m: {progress.words}")

            truths.append(truth(session, seen, size, size, judge, inner))
            pictures.append(converged(session, seen, size, size))
        exact = [one.linear for one in truths]
        means = np.array([[p.linear[..., :3].mean(), t[..., :3].mean()] for p, t in zip(pictures, exact, strict=True)])
        if means[:, 1].min() <= 0:
            raise InputError("distances", f"{distance:g} m shows nothing but background")
        moved = np.diff(means[:, 0] - means[:, 1]) / means[:, 1].mean()
        whole = flicker([one.linear for one in pictures], exact)
        once = flicker([one.once for one in pictures if one.once is not None], exact)
        floor = flicker([one.once for one in truths], exact)
        found.append(
            Stretch(
                distance,
                footprint(distance),
                float(np.abs(moved).max()),
                whole.worst,
                whole.truth,
                once.value,
                floor.value,
            )
        )
    return found


def stretches(found: Sequence[Stretch]) -> str:
    """What pops and shimmers as a Markdown table."""
    heads = ["distance, m", "pixel, m", "pop of the mean", "worst jump of the pixels", "the truth's pixels move by",
             "one frame's shimmer", "that of one ray a pixel"]  # fmt: skip
    rows = [
        f"| {one.distance:g} | {one.footprint:.3g} | {one.pop:.4f} | {one.jump:.4f} | {one.truth:.4f} "
        f"| {one.shimmer:.4f} | {one.floor:.4f} |"
        for one in found
    ]
    return "\n".join(["| " + " | ".join(heads) + " |", "|" + " ---: |" * len(heads), *rows])


def table(lines: Sequence[Line]) -> str:
    """The lines as a Markdown table."""
    rows = [
        f"| {line.distance:g} | {line.footprint:.3g} | {line.mean:.4g} | {line.reference:.4g} | {line.ratio:.3f} "
        f"| {line.standard_error:.4f} | {line.relative_rmse:.3f} |"
        for line in lines
    ]
    head = "| distance, m | pixel, m | mean | reference | ratio | standard error | relative RMSE |"
    return "\n".join([head, "| ---: | ---: | ---: | ---: | ---: | ---: | ---: |", *rows])
