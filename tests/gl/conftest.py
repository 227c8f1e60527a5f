"""One OpenGL thread a test file; every test must leave as many objects as it found, and closing must find none."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from renderer.gl.thread import GLThread


@pytest.fixture(scope="module")
def thread() -> Iterator[GLThread]:
    """A running OpenGL thread, closed without a leak after the file's tests."""
    with GLThread() as running:
        yield running


@pytest.fixture(autouse=True)
def no_leak(request: pytest.FixtureRequest) -> Iterator[None]:
    """Fail a test that leaves objects behind, programs of the cache apart."""
    if "thread" not in request.fixturenames:
        yield
        return
    thread: GLThread = request.getfixturevalue("thread")

    def kept() -> dict[str, int]:
        counts = dict(thread.call(lambda gl: gl.live_objects()))
        return {kind: count for kind, count in counts.items() if kind not in ("Program", "VertexArray")}
    before = kept()
    yield
    assert kept() == before
