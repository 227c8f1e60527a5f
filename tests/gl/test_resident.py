"""The bounded cache of GPU objects: made once, the longest unasked released first, nothing left behind."""

from __future__ import annotations

import math

import numpy as np
import pytest

from renderer.gl.context import GL
from renderer.gl.layers import Layers
from renderer.gl.resident import Resident, bytes_of
from renderer.gl.thread import GLThread


def test_entries_are_made_once_and_the_oldest_leaves_first(thread: GLThread) -> None:
    def job(gl: GL) -> list[str]:
        kept = Resident(gl, 2)
        made: list[str] = []

        def entry(name: str) -> None:
            def make() -> dict[str, object]:
                made.append(name)
                return {"texture": gl.texture2d(np.zeros((2, 2), np.uint8))}

            kept.get(name, make)  # type: ignore[arg-type]

        for name in ("a", "b", "a", "c", "a", "b"):
            entry(name)
        kept.release()
        gl.forget(kept)
        return made

    before = thread.live_objects()
    assert thread.call(job) == ["a", "b", "c", "b"]
    assert thread.live_objects() == before


@pytest.mark.parametrize(("bytes_kept", "kept"), [(math.inf, 3), (1100, 2), (1000, 1), (10, 1)])
def test_large_entries_leave_sooner(thread: GLThread, bytes_kept: float, kept: int) -> None:
    def job(gl: GL) -> int:
        found = Resident(gl, 3, bytes_kept)
        before = gl.live_objects().total()
        for name in range(5):
            found.get(name, lambda: {"texture": gl.texture2d(np.zeros((8, 16, 4), np.uint8))})  # 512 bytes
        held = gl.live_objects().total() - before
        found.release()
        gl.forget(found)
        return held

    assert thread.call(job) == kept


def test_the_size_of_an_entry_is_its_texels(thread: GLThread) -> None:
    def job(gl: GL) -> list[int]:
        made = [gl.texture3d(np.zeros((4, 8, 16, 2), np.uint16)), gl.texture2d(np.zeros((3, 5), np.float32)),
                Layers(gl, 7, 11, ((1, "f4"), (4, "f2")))]  # fmt: skip
        found = [bytes_of(one) for one in made]
        for one in made:
            one.release()
        return found

    assert thread.call(job) == [4 * 8 * 16 * 2 * 2, 3 * 5 * 4, 7 * 11 * (4 + 8)]
