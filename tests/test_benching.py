"""What moves between two timed frames."""

from __future__ import annotations

import math
from concurrent.futures import Future
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer.benching import STEP_DEGREES, Stopwatch, moved
from renderer.core.params import merge, validate
from renderer.core.registry import phenomenon
from renderer.study.sweep import Case
from renderer.world.camera import Orthographic, rays

FOREST = phenomenon("forest")


@pytest.mark.parametrize("preset", FOREST.presets)
def test_a_moving_camera_sees_something_else_at_every_preset(preset: str) -> None:
    state = validate(FOREST.state, merge(FOREST.state().model_dump(mode="json"), FOREST.presets[preset].patch))
    seen = [rays(moved(state, "camera", turn).camera, 3, 3) for turn in (0, 1, 4)]
    if isinstance(state.camera, Orthographic):
        # parallel rays do not turn: they go aside
        gone = [math.dist(origins[1, 1], seen[0][0][1, 1]) for origins, _ in seen]
        assert gone == pytest.approx([turn * STEP_DEGREES / 360 * state.camera.width for turn in (0, 1, 4)])
        return
    middle = [directions[1, 1] for _, directions in seen]
    level = [direction[:2] / np.hypot(*direction[:2]) for direction in middle]
    for turn, after in zip((1, 4), level[1:], strict=True):
        angle = math.degrees(math.acos(min(float(level[0] @ after), 1.0)))
        assert angle == pytest.approx(turn * STEP_DEGREES, abs=1e-4)
    assert moved(state, "nothing", 3) == state


def test_a_timed_frame_follows_one_of_its_own_case() -> None:
    drawn: list[Any] = []

    class View:
        def frame(self, state: Any, *size: int) -> Future[Any]:
            drawn.append(state.light.kind)
            told: Future[Any] = Future()
            told.set_result(SimpleNamespace(render_ms=float(len(drawn))))
            return told

    session: Any = SimpleNamespace(view=View, prepared=lambda state: True)
    base = FOREST.state().model_dump(mode="json")
    states = {kind: validate(FOREST.state, merge(base, {"light": {"kind": kind}})) for kind in ("lambert", "gouraud")}
    watch = Stopwatch(session, "forest", (4, 4), lambda case: states[case.techniques["light"]])
    cases = [Case("noon", "preset", {"light": kind}, {"moves": "sun"}) for kind in states]
    told = [watch.frame_ms(case) for case in (cases[0], cases[0], cases[1], cases[0])]
    assert drawn == ["lambert"] * 3 + ["gouraud"] * 2 + ["lambert"] * 2
    assert told == [2.0, 3.0, 5.0, 7.0]
