"""Layers drawn at once, and the store that keeps them while asked for and draws over them when room is short."""

from __future__ import annotations

import numpy as np
import pytest

from renderer.core.errors import LimitError
from renderer.gl.context import GL
from renderer.gl.layers import Layers, LayerStore
from renderer.gl.source import assemble
from renderer.gl.targets import run_fullscreen
from renderer.gl.thread import GLThread

KINDS = ((2, "f4"), (4, "nu2"))
SIZE = (6, 4)
BYTES = SIZE[0] * SIZE[1] * (2 * 4 + 4 * 2)
BODY = """layout(location = 0) out vec2 first;
layout(location = 1) out vec4 second;
void main() {
    first = gl_FragCoord.xy * shade;
    second = vec4(shade, 0.25, 0.5, 1.0);
}"""


def fill(gl: GL, layers: Layers, shade: float) -> None:
    layers.use()
    run_fullscreen(gl, assemble([], declarations="uniform float shade;", body=BODY), {}, {"shade": shade})


def read(texture: object, components: int, dtype: str) -> np.ndarray:
    return np.frombuffer(texture.read(), dtype).reshape(SIZE[1], SIZE[0], components)  # type: ignore[attr-defined]


@pytest.mark.parametrize("size", [(0, 4), (100_000, 4), (4, 100_000)])
def test_a_size_that_cannot_be_drawn_is_refused_with_its_limit(thread: GLThread, size: tuple[int, int]) -> None:
    with pytest.raises(LimitError, match=r"1 to [0-9]+ a side"):
        thread.call(lambda gl: Layers(gl, *size, KINDS))


def test_both_layers_hold_what_was_drawn(thread: GLThread) -> None:
    def job(gl: GL) -> tuple[np.ndarray, np.ndarray]:
        layers = Layers(gl, *SIZE, KINDS)
        fill(gl, layers, 1.0)
        found = read(layers.textures[0], 2, "f4").copy(), read(layers.textures[1], 4, "u2").copy()
        layers.release()
        return found

    places, voxels = thread.call(job)
    assert places[2, 3].tolist() == [3.5, 2.5]
    assert voxels[0, 0] / 65535 == pytest.approx([1.0, 0.25, 0.5, 1.0], abs=1e-5)


@pytest.mark.parametrize(("room", "redrawn"), [(3 * BYTES, 0), (2 * BYTES, 1), (1, 1)])
def test_the_store_draws_again_only_what_it_had_no_room_for(thread: GLThread, room: int, redrawn: int) -> None:
    def job(gl: GL) -> tuple[int, float]:
        store = LayerStore(gl, KINDS, room)
        drawn = []

        def show(key: str, shade: float) -> float:
            def draw(layers: Layers) -> None:
                drawn.append(key)
                fill(gl, layers, shade)

            return float(read(store.get(key, SIZE, draw)[0], 2, "f4")[0, 0, 0])

        values = [show("a", 2.0), show("b", 4.0), show("c", 6.0), show("c", 6.0), show("a", 2.0)]
        store.release()
        assert values == [1.0, 2.0, 3.0, 3.0, 1.0]
        return len(drawn) - 3, values[-1]

    assert thread.call(job)[0] == redrawn


def test_a_failed_drawing_is_not_kept_and_leaks_nothing(thread: GLThread) -> None:
    def job(gl: GL) -> None:
        store = LayerStore(gl, KINDS, BYTES)

        def fail(layers: Layers) -> None:
            raise ValueError("no picture")

        with pytest.raises(ValueError, match="no picture"):
            store.get("a", SIZE, fail)
        store.get("a", SIZE, lambda layers: fill(gl, layers, 1.0))
        store.get("a", (9, 9), lambda layers: fill(gl, layers, 1.0))
        store.release()

    thread.call(job)
