"""The bounded cache of GPU objects: made once, the longest unasked released first, nothing left behind."""

from __future__ import annotations

import numpy as np

from renderer.gl.context import GL
from renderer.gl.resident import Resident
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
