"""The moment's map as it is drawn, against the one that numpy makes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from renderer.clouds import moving_map
from renderer.clouds.cloud_map import thickness_map
from renderer.clouds.planet import ProceduralClouds
from renderer.clouds.textures import with_slopes
from renderer.gl.context import GL
from renderer.gl.thread import GLThread

FIELDS = {"fields": np.random.default_rng(6).standard_normal((2, 64, 64)).astype(np.float32)}
SIDE = 64e3


def drawn(thread: GLThread, clouds: ProceduralClouds, time: float) -> np.ndarray:
    """(64, 64, 4)."""

    def job(gl: GL) -> np.ndarray:
        fields: Any = moving_map.field_texture(gl, FIELDS)
        made: Any = moving_map.moving_map(gl, clouds, fields, SIDE, time)["cloud_map"]
        try:
            return np.frombuffer(made.read(), np.float16).reshape(64, 64, 4).astype(float)
        finally:
            made.release()
            fields["moment_fields"].release()

    moving_map._stage.cache_clear()
    return thread.call(job)


def off(thread: GLThread, time: float, **given: Any) -> float:
    """Greatest difference of the four channels, over each one's greatest value."""
    clouds = ProceduralClouds(systems=False, **given)
    twin = with_slopes(thickness_map(clouds, FIELDS, time), SIDE)
    apart = np.abs(drawn(thread, clouds, time) - twin).max(axis=(0, 1))
    return float((apart / np.abs(twin).max(axis=(0, 1))).max())


@pytest.mark.parametrize(
    ("time", "given"), [(0.0, {}), (900.0, {"cover": 1.0}), (5000.0, {"cover": 0.2, "variation": 1.0})]
)
def test_it_is_numpy_s_to_half_precision(thread: GLThread, time: float, given: dict[str, Any]) -> None:
    assert off(thread, time, **given) < 6e-4


def test_an_edge_of_another_width_is_found(thread: GLThread, spoil: Callable) -> None:
    with spoil("clouds/moment.glsl", "exp(-abs(above))", "exp(-0.9 * abs(above))"):
        assert off(thread, 900.0) > 5e-3
    moving_map._stage.cache_clear()
