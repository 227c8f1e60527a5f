"""What a frame costs: every technique and preset, timed in turns, in milliseconds and in yardsticks."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.registry import phenomenon, techniques
from renderer.study.horizon_bench import time_horizons
from renderer.study.sweep import FRAMES, Case, clock, provenance
from renderer.study.yardstick import Yardstick
from renderer.world.camera import Look, Orthographic, pose
from renderer.world.state import SceneState, View
from renderer.world.sun import SunDirection, angles

if TYPE_CHECKING:
    from renderer.session import Session

__all__ = ["FRAMES", "provenance", "time_frames", "time_horizons"]

Progress = Callable[[float, str], None]

SIZES = ((512, 512), (1280, 720))
"""Width and height of the timed pictures."""

STEP_DEGREES = 0.25
"""How far the sun or the camera turns from one timed frame to the next, where it moves."""

COMBINATION = "combination"
"""Stands for all slots in a case that names a combination of techniques."""

MOVES = ("nothing", "sun", "camera")
"""What moves between two frames: what a frame keeps from the last one depends on it."""


class Stopwatch:
    """Draws single interactive frames and tells what each took, from an empty canvas to the displayed pixels in memory.

    Args:
        session: draws.
        scene: its name.
        size: width and height, pixels.
        states: what a case means; `state_of` where it is not given.
    """

    def __init__(
        self,
        session: Session,
        scene: str,
        size: tuple[int, int],
        states: Callable[[Case], SceneState] | None = None,
    ) -> None:
        self._session = session
        self._states = states or (lambda case: state_of(session, scene, case))
        self._size = size
        self._view = session.view()
        self._turn = 0
        self._last: Case | None = None

    def frame_ms(self, case: Case) -> float:
        """Milliseconds of the next frame of a case; what moves in it (`moves`) has moved on by a step."""
        # What a case keeps from frame to frame is its own: another's frame before it would be charged to it.
        if case != self._last:
            self._next(case)
        self._last = case
        return self._next(case)

    def _next(self, case: Case) -> float:
        # No two frames share a turn, whatever their case: one would be spared what the other has traced.
        self._turn += 1
        moves = str(case.parameters.get("moves", MOVES[0]))
        state = moved(self._states(case), moves, self._turn)
        if not self._session.prepared(state):
            self._session.prepare(state).future.result()
        return float(self._view.frame(state, *self._size).result().render_ms)

    def close(self) -> None:
        """Free the canvas."""
        self._view.close()


def state_of(session: Session, scene: str, case: Case) -> SceneState:
    """The state that a case means: its preset with its techniques, under the sun and exposure that it sets."""
    chosen = dict(case.techniques)
    combination = chosen.pop(COMBINATION, None)
    sets: dict[str, Any] = {f"{slot}.kind": kind for slot, kind in chosen.items()}
    # one sample a frame; a frame of the same state as the last one still draws a sample, and adds it
    sets["quality"] = {"kind": "samples", "n": 4096}
    for name, path in (("sun", "sun"), ("exposure", "view.exposure")):
        if name in case.parameters:
            sets[path] = case.parameters[name]
    return session.state(scene, case.preset, sets, combination=combination)


def moved(state: SceneState, what: str, turn: int) -> SceneState:
    """A state whose sun or camera has turned by some steps about the vertical."""
    if what == "nothing":
        return state
    part: Any = state.camera
    if what == "camera" and isinstance(part, Look):
        return state.model_copy(update={what: _looking_aside(part, turn)})
    if what == "camera" and isinstance(part, Orthographic):
        return state.model_copy(update={what: _moved_aside(part, turn)})
    if what == "sun":
        azimuth, elevation = angles(state.sun)
        part = SunDirection(azimuth=math.degrees(azimuth), elevation=math.degrees(elevation))
    turned = part.model_copy(update={"azimuth": (part.azimuth + turn * STEP_DEGREES) % 360.0})
    return state.model_copy(update={what: turned})


def _looking_aside(camera: Look, turn: int) -> Look:
    """The camera turned on the spot."""
    angle = math.radians(turn * STEP_DEGREES)
    x, y, z = (end - start for start, end in zip(camera.eye, camera.target, strict=True))
    turned = (x * math.cos(angle) + y * math.sin(angle), y * math.cos(angle) - x * math.sin(angle), z)
    target = tuple(start + way for start, way in zip(camera.eye, turned, strict=True))
    return camera.model_copy(update={"target": target})


def _moved_aside(camera: Orthographic, turn: int) -> Orthographic:
    """The parallel view moved to its right by as large a share of its width as a step is of a whole turn."""
    moved = np.add(camera.centre, turn * STEP_DEGREES / 360 * camera.width * pose(camera).right)
    return camera.model_copy(update={"centre": tuple(map(float, moved))})


MOVED = ("shadow", "bounce")
"""Slots whose techniques do most anew while sun or camera move, of which a scene has one."""


def variants(scene: str) -> list[dict[str, str]]:
    """The default techniques, and those with one slot filled otherwise, the default first."""
    slots = phenomenon(scene).slots
    default = {slot.name: slot.default for slot in slots}
    others = [
        {**default, slot.name: kind}
        for slot in slots
        for kind in techniques(scene, slot.name)
        if kind != slot.default
    ]
    return [default, *others]


def time_frames(
    session: Session,
    scene: str,
    results: Path,
    machine: Mapping[str, Any],
    frames: int = FRAMES,
    presets: tuple[str, ...] = (),
    progress: Progress | None = None,
) -> list[dict[str, Any]]:
    """Time every technique at every preset, and those that do most anew while the sun and the camera move (`MOVED`).

    Techniques are timed in turns within a preset: ratios between them come from one run. Large pictures of all but the
    first preset are timed a third as often.

    Args:
        session: draws.
        scene: its name.
        results: JSON lines to add to.
        machine: where it runs.
        frames: timed frames of each, as far as stated.
        presets: all where none is named, but for those made for one purpose.
        progress: told the share done.
    """
    names = presets or tuple(name for name, preset in phenomenon(scene).presets.items() if not preset.group)
    stick = session.gl.call(Yardstick)
    groups = list(_groups(scene, names))
    found = []
    for number, cases in enumerate(groups):
        for column, size in enumerate(SIZES):
            watch = Stopwatch(session, scene, size)
            done = number + column / len(SIZES)
            often = frames if column == 0 or groups[number][0].preset == names[0] else max(1, frames // 3)

            def tell(share: float, words: str, done: float = done) -> None:
                if progress is not None:
                    progress((done + share / len(SIZES)) / len(groups), words)

            try:
                found += clock(
                    results, cases, watch.frame_ms, size, machine, lambda: session.gl.call(stick.draw_ms), often, tell
                )
            finally:
                watch.close()
    return found


def _groups(scene: str, presets: tuple[str, ...]) -> Iterator[list[Case]]:
    """Cases that are timed in turns."""
    for preset in presets:
        yield [Case(preset, "preset", chosen, {"moves": MOVES[0]}) for chosen in variants(scene)]
    default = variants(scene)[0]
    slot = next(slot.name for slot in phenomenon(scene).slots if slot.name in MOVED)
    for what in MOVES[1:]:
        yield [
            Case(presets[0], "preset", {**default, slot: kind}, {"moves": what}) for kind in techniques(scene, slot)
        ]


SUNS: Mapping[str, dict[str, Any]] = {
    "morning": {"kind": "direction", "azimuth": 105.0, "elevation": 30.0},
    "noon": {"kind": "direction", "azimuth": 185.0, "elevation": 62.0},
    "evening": {"kind": "direction", "azimuth": 262.0, "elevation": 15.0},
}
"""Three suns under which every preset is pictured."""


OWN = ""
"""The sun of the preset itself."""


def suns_of(scene: str) -> tuple[str, ...]:
    """Suns under which a scene's presets are pictured: what clouds and shells show, they show under their own."""
    return (OWN,) if scene in ("clouds", "shells") else tuple(SUNS)


def pictured(session: Session, scene: str, preset: str, sun: str) -> SceneState:
    """The state of a preset's picture under one of `SUNS`, or `OWN`."""
    if sun == OWN:
        return session.state(scene, preset, {"quality": {"kind": "samples", "n": 32}})
    return session.state(
        scene,
        preset,
        None,
        {"sun": SUNS[sun], "quality": {"kind": "samples", "n": 32}, "view": {"exposure": View().exposure}},
    )
