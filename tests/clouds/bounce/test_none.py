"""No bounce: nothing comes back to either."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from renderer.clouds.bounce.none import NoBounce

Ask = Callable[..., np.ndarray]


def test_ground_and_cloud_get_nothing(ask: Ask) -> None:
    for function in ("bounce_ground", "bounce_cloud"):
        assert ask({"bounce": NoBounce()}, f"{function}(p)", {"p": np.array([[3.0, 4.0]])}) == pytest.approx(
            np.zeros((1, 3))
        )


def test_light_from_nowhere_is_found(ask: Ask, spoil: Callable) -> None:
    with spoil(
        "clouds/bounce/none.glsl",
        "vec3 bounce_cloud(vec2 place) {\n    return vec3(0.0);",
        "vec3 bounce_cloud(vec2 place) {\n    return vec3(1.0);",
    ):
        assert ask({"bounce": NoBounce()}, "bounce_cloud(p)", {"p": np.array([[3.0, 4.0]])}).min() > 0.5
