"""What moves between two timed frames."""

from __future__ import annotations

import math

import numpy as np
import pytest

from renderer.benching import STEP_DEGREES, moved
from renderer.core.params import merge, validate
from renderer.core.registry import phenomenon
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
