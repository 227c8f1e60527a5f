from __future__ import annotations

import numpy as np

from renderer.gl.thread import GLThread
from renderer.study.yardstick import SIDE, VOLUME, Yardstick


def composited(volume: np.ndarray, column: int, row: int) -> np.ndarray:
    """The definition in numpy: 64 trilinear samples, front to back, alpha scaled by 0.05."""
    layers, rows, columns, _ = volume.shape
    total = np.zeros(4)
    for i in range(64):
        place = np.array([(column + 0.5) / SIDE * columns, (row + 0.5) / SIDE * rows, (i + 0.5) / 64 * layers]) - 0.5
        base = np.floor(place).astype(int)
        texel = np.zeros(4)
        for corner in np.ndindex(2, 2, 2):
            x, y, z = (base + corner) % (columns, rows, layers)
            texel += np.prod(np.abs(1 - np.array(corner) - (place - base))) * volume[z, y, x] / 255
        alpha = 0.05 * texel[3]
        total += (1 - total[3]) * alpha * np.array([*texel[:3], 1.0])
    return total


def test_the_yardstick_draws_what_its_definition_says() -> None:
    volume = np.random.Generator(np.random.PCG64(0)).integers(0, 256, VOLUME, np.uint8)
    with GLThread() as thread:
        stick = thread.call(Yardstick)
        assert thread.call(stick.draw_ms) > 0
        picture = thread.call(lambda gl: stick.picture())
    assert picture.shape == (SIDE, SIDE, 4)
    for column, row in [(0, 0), (100, 37), (511, 300), (256, 511)]:
        expected = composited(volume, column, row) * 255
        assert np.abs(picture[SIDE - 1 - row, column] - expected).max() < 1.5
        # an early stop, or an alpha not scaled, would be far off
        assert 0.7 * 255 < expected[3] < 0.9 * 255
