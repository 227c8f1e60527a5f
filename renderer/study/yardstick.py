"""The yardstick: a unit of time that travels between machines.

One yardstick is the time, in the same run as the figures it divides, of a full-screen 512 x 512 shader that takes 64
trilinear samples of a 128 x 128 x 32 RGBA8 volume of random content a pixel and composites them front to back, alpha
scaled by 0.05, without an early stop, into an RGBA8 target: the median of 20 draws with a finish after each. About
40 ms on two cores of llvmpipe.
"""

from __future__ import annotations

import numpy as np

from renderer.gl.context import GL
from renderer.gl.targets import Target, run_fullscreen

SIDE = 512
"""Pixels a side."""

VOLUME = (32, 128, 128, 4)
"""Layers, rows, columns and channels of the volume."""

DRAWS = 20


class Yardstick:
    """Draws the yardstick; lives on the GL thread, from `GLThread.call(Yardstick)` to the context's close."""

    def __init__(self, gl: GL) -> None:
        self._gl = gl
        content = np.random.Generator(np.random.PCG64(0)).integers(0, 256, VOLUME, np.uint8)
        self._volume = gl.texture3d(content, "linear", ("repeat", "repeat", "repeat"))
        self._target = Target(gl, SIDE, SIDE, dtype="f1")
        gl.at_close(self)
        self.draw_ms(gl)  # the first draw compiles

    def draw_ms(self, gl: GL) -> float:
        """Milliseconds of one draw, finished."""
        self._target.use()
        timer = gl.timer()
        with timer.measure():
            run_fullscreen(gl, "stages/yardstick.frag", {"volume": self._volume}, {"size": (SIDE, SIDE)})
        return timer.ms

    def median_ms(self, gl: GL) -> float:
        """One yardstick, ms."""
        return float(np.median([self.draw_ms(gl) for _ in range(DRAWS)]))

    def picture(self) -> np.ndarray:
        """What was drawn last, (512, 512, 4) uint8."""
        return self._target.read()

    def release(self) -> None:
        """Free the volume and the target."""
        self._volume.release()
        self._target.release()
