"""The clouds' pictures at coarser levels."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from renderer.clouds.planet import ProceduralClouds
from renderer.clouds.textures import halved, moment_map, with_slopes
from renderer.gl.context import GL
from renderer.gl.thread import GLThread

FIELDS = np.random.default_rng(6).standard_normal((2, 64, 64)).astype(np.float32)


@pytest.mark.parametrize("kind", [np.uint8, np.float16, np.float32])
def test_every_coarser_level_keeps_the_mean(kind: type) -> None:
    """Bytes must not run over as they are summed."""
    picture = np.random.default_rng(4).integers(100, 256, (64, 32, 3)).astype(kind)
    levels = halved(picture)
    assert [level.shape[:2] for level in levels] == [(32, 16), (16, 8), (8, 4), (4, 2), (2, 1)]
    for level in levels:
        assert level.mean(axis=(0, 1)) == pytest.approx(picture.astype(float).mean(axis=(0, 1)), rel=1e-5)


def test_open_sky_adds_nothing_to_the_mean_thickness() -> None:
    """Between clouds the map goes on below zero, for smooth edges; its last channel does not."""
    field = np.random.default_rng(5).standard_normal((16, 16)).astype(np.float32)
    made = with_slopes(field, 1600.0)
    assert np.array_equal(made[..., 0], field)
    assert np.array_equal(made[..., 3], np.maximum(field, 0))
    east = (np.roll(made[..., 3], -1, 1) - np.roll(made[..., 3], 1, 1)) / 200.0
    assert made[..., 1] == pytest.approx(east, abs=1e-6)


def test_the_levels_that_the_driver_makes_are_means(thread: GLThread) -> None:
    """A map that jumps from texel to texel, so that any other filter shows."""
    clouds, fields = ProceduralClouds(systems=False), {"fields": FIELDS}

    def levels(gl: GL) -> list[np.ndarray]:
        made: Any = moment_map(gl, clouds, fields, 64e3, 0.0)["cloud_map"]
        try:
            return [np.frombuffer(made.read(level=k), np.float16).reshape(64 >> k, 64 >> k, 4) for k in (0, 1, 2)]
        finally:
            made.release()

    whole, half, quarter = (level.astype(float) for level in thread.call(levels))
    assert half == pytest.approx(whole.reshape(32, 2, 32, 2, 4).mean(axis=(1, 3)), abs=2e-3)
    assert quarter == pytest.approx(whole.reshape(16, 4, 16, 4, 4).mean(axis=(1, 3)), abs=3e-3)
