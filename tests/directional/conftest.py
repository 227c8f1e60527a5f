"""One OpenGL thread for the directional textures' tests."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from renderer.gl.thread import GLThread


@pytest.fixture(scope="session")
def thread() -> Iterator[GLThread]:
    """A running OpenGL thread, closed without a leak after these tests."""
    with GLThread("directional-tests") as running:
        yield running
