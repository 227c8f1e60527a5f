"""The six scenes of Dufort 2005, table 6.1, as drawn by default and with the thesis' own settings, side by side.

Error of the converged picture against the reference, noise of one frame, and what a frame takes in yardsticks. Judged
are the middle of the picture that is timed, where voxels are as wide on the screen, several pixels; and the whole of a
smaller one, as other studies have it, where pixels are as wide as voxels and wider.
"""

from __future__ import annotations

import functools
import itertools
import json
import math
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.benching import moved
from renderer.comparing import converged, reference, truth
from renderer.study.sweep import compare, provenance
from renderer.study.yardstick import Yardstick

if TYPE_CHECKING:
    from renderer.session import Session
    from renderer.view import View
    from renderer.world.state import SceneState

SAMPLES: Mapping[str, int] = {
    "teapot_relief": 10,
    "teapot_wicker": 20,
    "vase_trees": 10,
    "vase_relief": 10,
    "plane_fog": 15,
    "tube_rocks": 10,
}
"""Samples a segment of each row (Dufort 2005, table 6.1)."""

SETTINGS = ("default", "thesis")
MOVES = ("camera", "sun")
SIDE = 512
"""Of the pictures that are timed."""

WARM = 2
"""Frames before those that count."""

FILES = ("headline.md", "results.json")

WHOLE = (
    "The whole: the same of a picture {} pixels a side, whose pixels are as wide as voxels and wider; in the middle a "
    "voxel is several pixels wide, and one ray of the reference tells nearly all of a pixel. "
)

Tell = Callable[[float, str], None]


def sets_of(preset: str, setting: str) -> dict[str, Any]:
    """What of a preset's document a setting changes: the thesis samples evenly, sorts by SXMPVO, asks one depth of a
    shadow map, reads the finest voxels and adds up in halves."""
    if setting == "default":
        return {}
    return {
        "order": {"kind": "sxmpvo"},
        "sampling": {"kind": "uniform", "samples": SAMPLES[preset]},
        "shadow": {"kind": "shadow_map"},
        "filter": {"kind": "none"},
        "accumulation": {"kind": "half"},
    }


def measure(
    session: Session, presets: Sequence[str], size: int, whole: int, frames: int, tell: Tell | None = None
) -> list[dict[str, Any]]:
    """One line a preset and setting.

    Args:
        presets: of `SAMPLES`. size, whole: sides of the middle and of the whole picture that are judged, pixels; 0 for
            no whole one. frames: timed of each, 0 for none. tell: told the share done.

    Returns:
        `preset`, `setting`, `relative_rmse`, `pairing`, `standard_error`, the same of the whole picture as
        `whole_relative_rmse` and so on, and what a frame takes in yardsticks by processor time, `camera` and `sun`
        moving, and by the clock, `camera_clock` and `sun_clock`.
    """
    lines = []
    for number, preset in enumerate(presets):
        if tell is not None:
            tell(number / len(presets), preset)
        states = {setting: session.state("shells", preset, sets_of(preset, setting)) for setting in SETTINGS}
        taken = times(session, states, frames)
        for setting, state in states.items():
            of_whole = judged(session, state, whole) if whole else {}
            lines.append({
                "preset": preset, "setting": setting, "size": size, "whole": whole, "frames": frames, **taken[setting],
                **judged(session, middle(state, size), size),
                **{f"whole_{name}": number for name, number in of_whole.items()},
                "machine": provenance(session.gl.info.renderer),
            })  # fmt: skip
    return lines


def judged(session: Session, state: SceneState, size: int) -> dict[str, float]:
    """How a picture of `size` pixels a side converges to its reference, and how far one frame is from there."""
    found = truth(session, state, size, size)
    numbers = compare(
        converged(session, state, size, size), reference(found, state.view, session.exposure_ev(state))
    )
    return {
        "relative_rmse": numbers["relative_rmse"],
        "pairing": numbers["pairing"],
        "standard_error": numbers["reference_standard_error"],
    }


def middle(state: SceneState, size: int) -> SceneState:
    """The middle of a picture of `SIDE` pixels a side, `size` of them wide, in the same perspective."""
    camera: Any = state.camera
    half = math.tan(math.radians(camera.field_of_view) / 2) * size / SIDE
    narrow = camera.model_copy(update={"field_of_view": math.degrees(2 * math.atan(half))})
    return state.model_copy(update={"camera": narrow})


def times(session: Session, states: Mapping[str, SceneState], frames: int) -> dict[str, dict[str, float]]:
    """What a frame of each state takes, in turns with the yardstick: medians of the quotients."""
    yardstick, view = session.gl.call(Yardstick), session.view()
    taken: dict[str, dict[str, list[float]]] = {name: {} for name in states}
    try:
        # One setting and one motion at a time, so that each frame finds again what did not move.
        for (name, state), what in itertools.product(states.items(), MOVES):
            for turn in range((frames + WARM) if frames else 0):
                unit = _both(lambda: session.gl.call(yardstick.draw_ms))
                shown = moved(state, what, turn + 1)
                session.prepare(shown).future.result()
                frame = _both(functools.partial(_drawn, view, shown))
                if turn >= WARM:
                    taken[name].setdefault(what, []).append(frame[0] / unit[0])
                    taken[name].setdefault(f"{what}_clock", []).append(frame[1] / unit[1])
    finally:
        view.close()
    return {name: {what: float(np.median(of)) for what, of in found.items()} for name, found in taken.items()}


def _drawn(view: View, state: SceneState) -> None:
    view.frame(state, SIDE, SIDE).result()


def _both(work: Callable[[], Any]) -> tuple[float, float]:
    """Processor time and time by the clock of some work, s."""
    busy, clock = time.process_time(), time.perf_counter()
    work()
    return time.process_time() - busy, time.perf_counter() - clock


COLUMNS = (
    ("error", "relative_rmse"), ("one frame's noise", "pairing"),
    ("error of the whole", "whole_relative_rmse"), ("its one frame's noise", "whole_pairing"),
    ("camera moving", "camera"), ("sun moving", "sun"),
)  # fmt: skip


def table(lines: Sequence[Mapping[str, Any]]) -> str:
    """The lines as a Markdown table, one row a preset."""
    heads = [f"{setting}: {heading}" for setting in SETTINGS for heading, _ in COLUMNS]
    rows = [["scene", "its samples", *heads], ["---"] + ["---:"] * (1 + len(heads))]
    for preset in dict.fromkeys(line["preset"] for line in lines):
        own = {line["setting"]: line for line in lines if line["preset"] == preset}
        cells = [_cell(own[setting].get(key)) for setting in SETTINGS for _, key in COLUMNS]
        rows.append([f"`{preset}`", str(SAMPLES[preset]), *cells])
    return "".join("| " + " | ".join(row) + " |\n" for row in rows)


def write(lines: Sequence[Mapping[str, Any]], folder: Path) -> str:
    """Write `FILES`, and return the page's text."""
    folder.mkdir(parents=True, exist_ok=True)
    machine, whole = lines[0]["machine"], lines[0]["whole"]
    noise = max(line.get(name, 0.0) for line in lines for name in ("standard_error", "whole_standard_error"))
    text = (
        f"The six rows of Dufort 2005, table 6.1: {machine['renderer']}, {machine['cores']} cores\n\n"
        f"By default, and with the thesis' settings: its samples a segment, sorted by SXMPVO, a plain shadow map, the "
        f"finest voxels, sums in halves. Error: relative RMSE of the converged picture's middle, {lines[0]['size']} of "
        f"{SIDE} pixels a side, against the reference, whose standard error is {noise:.2g} at most. One frame's noise: "
        f"its distance from the converged picture, over that of the reference with one ray a pixel; up to 1.25 a frame "
        f"counts as the picture. {WHOLE.format(whole) if whole else ''}Moving: one frame of {SIDE} x {SIDE} in "
        f"yardsticks of processor time, median of {lines[0]['frames']}.\n\n{table(lines)}"
    )
    (folder / FILES[0]).write_text(text, encoding="utf-8")
    (folder / FILES[1]).write_text(json.dumps(list(lines), indent=1), encoding="utf-8")
    return text


def _cell(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"
