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
from renderer.world.state import SceneState, exposure_ev, samples_of

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
            prepared = drawer.prepare(state, baked, sums.size, place(sample), sample)
            sums.draw(sample, lambda frame=prepared: drawer.draw(frame))  # type: ignore[misc]

    def displayed(self, gl: GL, sums: Accumulator, state: SceneState, exposure: float) -> Any:
        """The picture as displayed, (height, width, 3) uint8, at an exposure in EV."""
        if self._tone is None:
            self._tone = ToneMap(gl)
            gl.at_close(self._tone)
        self._tone.draw(
            sums.sum_texture,
            exposure_ev=exposure,
            curve=state.view.tone_curve,
            background=WHITE if state.view.background == "white" else BLACK,
            samples=sums.samples,
        )
        return self._tone.read_rgb8()

    def picture(self, gl: GL, state: SceneState, baked: Baked, sums: Accumulator, render_ms: float) -> Picture:
        """The finished picture of a sum of samples."""
        exposure = exposure_of(state, baked)
        meta = {"state": state.model_dump(mode="json"), "exposure_ev": exposure}
        meta |= {"renderer": gl.info.renderer, "software": gl.info.software}
        return Picture(sums.read_mean(), self.displayed(gl, sums, state, exposure), sums.samples, render_ms, meta)


def exposure_of(state: SceneState, baked: Baked) -> float:
    """Stops by which a state's radiance is brightened for display, EV."""
    arrays = {name: entry.arrays for name, entry in baked.items()}
    return exposure_ev(state.view, phenomenon(state.scene).metered_light(state, arrays))


def paint(
    thread: GLThread,
    painter: Painter,
    state: SceneState,
    baked: Baked,
    size: tuple[int, int],
    samples: int,
    place: Place = offset,
    on_sample: Callable[[int], None] = lambda done: None,
) -> Picture:
    """Draw a whole picture, each sample in a turn of its own so that no view waits for all of them; blocks.

    Args:
        samples: a pixel, each at its `place` in the pixel.
        on_sample: told how many are done; may raise `Cancelled`.
    """
    started = time.perf_counter()
    sums = thread.call(_new_sums, size)
    try:
        for done in range(samples):
            on_sample(done)
            thread.submit(painter.add_samples, sums, state, baked, 1, place).result()
        return thread.submit(painter.picture, state, baked, sums, (time.perf_counter() - started) * 1e3).result()
    finally:
        thread.submit(_free_sums, sums)


def _new_sums(gl: GL, size: tuple[int, int]) -> Accumulator:
    sums = Accumulator(gl, *size)
    gl.at_close(sums)
    return sums


def _free_sums(gl: GL, sums: Accumulator) -> None:
    gl.forget(sums)
    sums.release()


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

    def probe(self, state: SceneState, x: float, y: float) -> Future[dict[str, Any]]:
        """What lies at a point of the picture last drawn: the scene's own facts, and the radiance there.

        Args:
            state: checked and prepared. x, y: place in the picture, in [0, 1], row 0 at the top.
        """
        return self._thread.submit(self._probe, state, x, y)

    def close(self) -> None:
        """Free the canvas."""
        self._thread.submit(self._release)

    def _draw(self, gl: GL, state: SceneState, size: tuple[int, int], more: int) -> Frame:
        started = time.perf_counter()
        if self._sums is None:
            self._sums = _new_sums(gl, size)
        if self._sums.size != size:
            self._sums.resize(*size)
        wanted = samples_of(state.quality)
        shown_alike = {"auto_exposure": False, "exposure": 0.0, "tone_curve": "linear"}
        drawn = state.model_copy(update={"view": state.view.model_copy(update=shown_alike), "quality": None})
        shown = (drawn.model_dump_json(warnings=False), size)
        if shown != self._shown or self._sums.samples > wanted:
            self._sums.samples = 0
            self._shown = shown
        count = min(more, wanted - self._sums.samples)
        baked = self._arrays(state)
        self._painter.add_samples(gl, self._sums, state, baked, count)
        rgb8 = self._painter.displayed(gl, self._sums, state, exposure_of(state, baked))
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

    def _probe(self, gl: GL, state: SceneState, x: float, y: float) -> dict[str, Any]:
        arrays = {name: entry.arrays for name, entry in self._arrays(state).items()}
        size = self._sums.size if self._sums is not None else (512, 512)
        facts = phenomenon(state.scene).probe(state, arrays, x, y, size)
        if self._sums is not None and self._sums.samples:
            column, row = min(int(x * size[0]), size[0] - 1), min(int(y * size[1]), size[1] - 1)
            facts["radiance"] = [float(value) for value in self._sums.read_mean()[row, column, :3]]
        return facts

    def _release(self, gl: GL) -> None:
        if self._sums is not None:
            _free_sums(gl, self._sums)
            self._sums = None


def technique_words(state: SceneState) -> str:
    """The chosen techniques by their titles."""
    slots = phenomenon(state.scene).slots
    return " + ".join(getattr(state, slot.name).title for slot in slots)
