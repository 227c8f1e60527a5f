"""A picture beside its reference: the two and the error as files, and the numbers."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.channel import Progress
from renderer.study.metrics import error_map
from renderer.study.sweep import Drawn
from renderer.study.sweep import compare as numbers_of
from renderer.truth import POSITIONS, Judge, Truth, truth_bake, truth_of
from renderer.world.image import display, save_image
from renderer.world.sampling import offset
from renderer.world.state import SceneState, View

if TYPE_CHECKING:
    from renderer.session import Session

Report = Callable[[Progress], None]

PASSES = 16
"""Samples at each of the reference's positions, differing in their jitter: their mean is the method without noise."""

NOISY = frozenset({"forest", "shells"})
"""Scenes whose samples differ at one position, too."""

REFERENCE_SHARE = 0.95
"""Share of a comparison's progress that the reference has."""

WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Comparison:
    """A picture against its reference.

    Attributes:
        files: `reference.png` and `picture.png` as displayed, over the state's background; `error.png` in false colour.
        numbers: `relative_rmse`, `gain`, `relative_rmse_after_gain`, `flip_mean`, `flip_p95`, `standard_error` of the
            reference (relative), `pairing`, `seconds` the reference took, `positions` a pixel, `size`, `judge`, and the
            error map's `legend`: (value in units of the reference's mean, (r, g, b)) from the bottom of its scale to
            its top, above which lies the share `saturated` of the pixels.
    """

    files: Mapping[str, bytes]
    numbers: Mapping[str, Any]


def place(sample: int) -> tuple[float, float]:
    """Where a sample of a converged picture lies in its pixel: at the reference's positions in turn."""
    return offset(sample % POSITIONS)


def truth(
    session: Session,
    state: SceneState,
    width: int,
    height: int,
    judge: Judge = "combination",
    on_progress: Report | None = None,
) -> Truth:
    """The reference of a state, from the cache where it is there; blocks.

    Raises:
        Cancelled: by `on_progress`.
    """
    return truth_of(session.compute(truth_bake(state, width, height, judge), on_progress))


def converged(session: Session, state: SceneState, width: int, height: int, passes: int = PASSES) -> Drawn:
    """The picture of a state without its sampling noise and without a background, at the reference's positions, each of
    them drawn `passes` times; once where nothing in a sample is drawn by chance."""
    passes = passes if state.scene in NOISY else 1
    bare = state.model_copy(update={"view": state.view.model_copy(update={"background": "none"})})
    whole = session.draw(bare, width, height, POSITIONS * passes, place)
    once = session.draw(bare, width, height, 1)
    shown = displayed(whole.linear, state.view, session.exposure_ev(state))
    return Drawn(whole.linear, shown, once.linear, whole.render_ms / 1e3)


def reference(found: Truth, view: View, exposure_ev: float) -> Drawn:
    """A reference in the form in which pictures are compared."""
    shown = displayed(found.linear, view, exposure_ev)
    return Drawn(found.linear, shown, found.once, found.seconds, found.standard_error)


def displayed(linear: np.ndarray, view: View, exposure_ev: float, backdrop: np.ndarray | None = None) -> np.ndarray:
    """A picture (H, W, 4) without background as a state displays it: over black, or over what is behind it.

    Args:
        linear: premultiplied radiance.
        view: tone curve and background.
        exposure_ev: EV over 1 W m-2 sr-1.
        backdrop: radiance of the sky behind it (H, W, 3); without one the background is black.
    """
    if backdrop is None:
        return display(linear, exposure_ev, view.tone_curve)
    if view.background == "sky":
        colours = linear[..., :3] + (1 - linear[..., 3:]) * backdrop
        linear = np.concatenate([colours, np.ones_like(linear[..., 3:])], axis=-1)
    return display(linear, exposure_ev, view.tone_curve, WHITE if view.background == "white" else BLACK)


def compare(
    session: Session,
    state: SceneState,
    width: int,
    height: int,
    on_progress: Report | None = None,
    judge: Judge = "combination",
) -> Comparison:
    """Compare a state's converged picture with its reference.

    The numbers speak of the scene alone, without the background: the sky's radiance would weigh most in the mean, and
    both pictures would share it.

    Args:
        session: draws, bakes and caches.
        state: a checked state.
        width, height: pixels; 128 to 256 a side are affordable.
        on_progress: told of the bakes and the reference; may raise `Cancelled`.
        judge: as `renderer.truth.Judge`.

    Raises:
        InputError: the reference shows nothing but background.
        Cancelled: by `on_progress`.
    """

    def report(progress: Progress) -> None:
        if on_progress is not None:
            on_progress(
                Progress(progress.name, REFERENCE_SHARE * progress.fraction, progress.words, progress.seconds_left)
            )

    found = truth(session, state, width, height, judge, report)
    if on_progress is not None:
        on_progress(Progress("picture", REFERENCE_SHARE, "drawing the picture that is compared", 1.0))
    picture = converged(session, state, width, height)
    exposure = session.exposure_ev(state)
    judged = reference(found, state.view, exposure)
    numbers = numbers_of(picture, judged)
    error = error_map(picture.linear, judged.linear)
    shown = {
        "reference.png": displayed(found.linear, state.view, exposure, found.backdrop),
        "picture.png": displayed(picture.linear, state.view, exposure, found.backdrop),
        "error.png": error.rgb8,
    }
    return Comparison(
        {name: save_image("png", rgb8) for name, rgb8 in shown.items()},
        {
            **{name: numbers[name] for name in NUMBERS},
            "standard_error": numbers["reference_standard_error"],
            "seconds": numbers["reference_seconds"],
            "positions": POSITIONS,
            "judge": judge,
            "legend": [[value, list(colour)] for value, colour in error.legend],
            "saturated": error.saturated,
        },
    )


NUMBERS = ("relative_rmse", "gain", "relative_rmse_after_gain", "flip_mean", "flip_p95", "pairing", "size")
"""Numbers of a comparison that keep the name they have in a study's results."""
