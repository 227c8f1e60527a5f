"""Canvases: each sums the samples of its own picture on the GL thread."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Any

from renderer.core.registry import phenomenon
from renderer.core.technique import BakedArrays, SceneRenderer
from renderer.gl.context import GL
from renderer.gl.targets import Accumulator, ToneMap
from renderer.gl.thread import GLThread
from renderer.picture import Frame, Picture
from renderer.world.sampling import offset
from renderer.world.state import SceneState, samples_of

Baked = Mapping[str, BakedArrays]
Place = Callable[[int], tuple[float, float]]
"""Where in its pixel a sample lies, by its number; from the top-left corner."""

WHITE = (1.0, 1.0, 1.0)
BLACK = (0.0, 0.0, 0.0)


class Painter:
    """The scene renderers and the display pass, shared by every view; used on the GL thread only."""

    def __init__(self, thread: GLThread) -> None:
        self._thread = thread
        self._renderers: dict[str, SceneRenderer] = {}
        self._tone: ToneMap | None = None

    def add_samples(
        self, gl: GL, sums: Accumulator, state: SceneState, baked: Baked, count: int, place: Place = offset
    ) -> None:
        """Add the next `count` samples of a state's picture to its sum, each at its `place` in the pixel."""
        if state.scene not in self._renderers:
            made = phenomenon(state.scene).open(gl)
            gl.at_close(made)
            self._renderers[state.scene] = made
        drawer = self._renderers[state.scene]
        for _ in range(count):
            sample = sums.samples
            sums.draw(sample, lambda n=sample: drawer.draw(state, baked, sums.size, place(n), n))  # type: ignore[misc]

    def displayed(self, gl: GL, sums: Accumulator, state: SceneState) -> Any:
        """The picture as displayed, (height, width, 3) uint8."""
        if self._tone is None:
            self._tone = ToneMap(gl)
            gl.at_close(self._tone)
        self._tone.draw(
            sums.sum_texture,
            exposure_ev=state.view.exposure,
            curve=state.view.tone_curve,
            background=WHITE if state.view.background == "white" else BLACK,
            samples=sums.samples,
        )
        return self._tone.read_rgb8()

    def picture(
        self, gl: GL, state: SceneState, baked: Baked, size: tuple[int, int], samples: int, place: Place = offset
    ) -> Picture:
        """Draw a whole picture of so many samples, each at its `place` in the pixel."""
        started = time.perf_counter()
        sums = Accumulator(gl, *size)
        try:
            self.add_samples(gl, sums, state, baked, samples, place)
            rgb8 = self.displayed(gl, sums, state)
            linear = sums.read_mean()
        finally:
            sums.release()
        meta = {"state": state.model_dump(mode="json"), "renderer": gl.info.renderer, "software": gl.info.software}
        return Picture(linear, rgb8, samples, (time.perf_counter() - started) * 1e3, meta)


class View:
    """One connected canvas.

    A frame of the same state and size as the last one adds samples to it; any other starts afresh.
    Two views never share a mean; they share textures and programs, and take turns on the GL thread.
    """

    def __init__(
        self, name: str, thread: GLThread, painter: Painter, arrays: Callable[[SceneState], dict[str, BakedArrays]]
    ) -> None:
        self._name = name
        self._thread = thread
        self._painter = painter
        self._arrays = arrays
        self._sums: Accumulator | None = None
        self._shown: tuple[str, tuple[int, int]] | None = None

    def frame(self, state: SceneState, width: int, height: int, more: int = 1) -> Future[Frame]:
        """Draw `more` samples and show the mean so far.

        A newer call replaces one that has not begun, whose future is cancelled.

        Args:
            state: checked and prepared.
            width, height: in pixels.
        """
        return self._thread.post(self._name, self._draw, state, (width, height), more)

    def close(self) -> None:
        """Free the canvas."""
        self._thread.submit(self._release)

    def _draw(self, gl: GL, state: SceneState, size: tuple[int, int], more: int) -> Frame:
        started = time.perf_counter()
        if self._sums is None:
            self._sums = Accumulator(gl, *size)
            gl.at_close(self._sums)
        if self._sums.size != size:
            self._sums.resize(*size)
        wanted = samples_of(state.quality)
        drawn = state.model_copy(
            update={"view": state.view.model_copy(update={"exposure": 0.0, "tone_curve": "linear"}), "quality": None}
        )
        shown = (drawn.model_dump_json(warnings=False), size)
        if shown != self._shown or self._sums.samples > wanted:
            self._sums.samples = 0
            self._shown = shown
        count = min(more, wanted - self._sums.samples)
        self._painter.add_samples(gl, self._sums, state, self._arrays(state), count)
        rgb8 = self._painter.displayed(gl, self._sums, state)
        samples = self._sums.samples
        return Frame(
            rgb8,
            *size,
            samples,
            wanted,
            samples >= wanted,
            (time.perf_counter() - started) * 1e3,
            technique_words(state),
        )

    def _release(self, gl: GL) -> None:
        if self._sums is not None:
            gl.forget(self._sums)
            self._sums.release()
            self._sums = None


def technique_words(state: SceneState) -> str:
    """The chosen techniques by their titles."""
    slots = phenomenon(state.scene).slots
    return " + ".join(getattr(state, slot.name).title for slot in slots)
