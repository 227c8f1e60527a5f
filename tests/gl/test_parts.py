"""A picture drawn in parts: each adds where the depth that is there lets it, and nothing else is drawn."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from renderer.gl.context import GL
from renderer.gl.layers import Layers, LayerStore
from renderer.gl.parts import Where, run_parts
from renderer.gl.source import Source, assemble
from renderer.gl.targets import Accumulator, run_fullscreen
from renderer.gl.thread import GLThread

COLUMNS = """layout(location = 0) out vec4 drawn;
void main() {
    drawn = vec4(1.0);
    gl_FragDepth = floor(gl_FragCoord.x) / 16.0;
}"""
"""Depth k / 16 in column k."""


@pytest.fixture(scope="module")
def thread() -> Iterator[GLThread]:
    with GLThread("parts") as running:
        yield running


def light(value: float) -> Source:
    return assemble([], body=f"layout(location = 0) out vec4 lit;\nvoid main() {{ lit = vec4({value!r}); }}")


def drawn(
    thread: GLThread, parts: list[tuple[Source, tuple[Where, ...]]], samples: int = 1, then: Source | None = None
) -> np.ndarray:
    """What each of eight columns holds after some samples, or after one pass more; both rows are alike."""

    def job(gl: GL) -> np.ndarray:
        store, sums = LayerStore(gl, ((4, "f4"),), 1 << 20, depth=True), Accumulator(gl, 8, 2)

        def fill(layers: Layers) -> None:
            layers.use()
            run_fullscreen(gl, assemble([], body=COLUMNS), {}, {}, writes_depth=True)

        depth = store.get("columns", (8, 2), fill)[-1]
        try:
            for sample in range(samples):
                sums.draw(sample, lambda: run_parts(gl, parts, depth, {}, {}))
            if then is not None:
                sums.draw(0, lambda: run_fullscreen(gl, then, {}, {}))
            found = sums.read_mean()[..., 0]
        finally:
            store.release()
            sums.release()
        assert (found[0] == found[1]).all()
        return np.asarray(found[0])

    return thread.call(job)


def test_parts_add_where_their_tests_hold(thread: GLThread) -> None:
    parts = [
        (light(1.0), ((">", 2.5 / 16),)),
        (light(10.0), (("==", 1 / 16), ("==", 5 / 16))),
        (light(100.0), (("<", 4.5 / 16),)),
    ]
    np.testing.assert_array_equal(drawn(thread, parts), [1, 11, 1, 0, 0, 110, 100, 100])


def test_samples_add_up_and_start_afresh(thread: GLThread) -> None:
    parts = [(light(2.0), (("==", 3 / 16),))]
    np.testing.assert_array_equal(drawn(thread, parts, samples=3), np.eye(8)[3] * 2)


def test_its_tests_do_not_hold_for_the_next_drawing(thread: GLThread) -> None:
    np.testing.assert_array_equal(drawn(thread, [(light(1.0), (("==", 0.5),))], then=light(7.0)), 7.0)
