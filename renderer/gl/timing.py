"""What a stretch of GPU work costs."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

import moderngl

from renderer.core.errors import UmbrageError


class GpuTimer:
    """Measures GPU work between entering and leaving `measure()`.

    On hardware it is OpenGL's own elapsed-time query. A software rasteriser answers such a query when commands are
    queued rather than when they have run, so there the clock is read with the queue drained on both sides.
    """

    def __init__(self, ctx: moderngl.Context, software: bool) -> None:
        self._ctx = ctx
        self._query = None if software else ctx.query(time=True)
        self._running = False
        self._pending = False
        self._ms: float | None = None

    @contextmanager
    def measure(self) -> Iterator[GpuTimer]:
        """Measure the enclosed GPU work; measurements do not nest, which OpenGL forbids.

        Raises:
            UmbrageError: a measurement is under way.
        """
        if self._running:
            raise UmbrageError("a GPU time measurement is already under way; they do not nest")
        self._running = True
        self._pending = False
        self._ms = None
        try:
            if self._query is not None:
                with self._query:
                    yield self
                self._pending = True
            else:
                self._ctx.finish()
                start = time.perf_counter()
                yield self
                self._ctx.finish()
                self._ms = (time.perf_counter() - start) * 1e3
        finally:
            self._running = False

    @property
    def ms(self) -> float:
        """Milliseconds that the last measurement took; waits for the GPU to have done the work.

        Raises:
            UmbrageError: nothing was measured yet.
        """
        if self._running:
            raise UmbrageError("the GPU time is known when the measurement is over")
        if self._pending and self._query is not None:
            self._pending = False
            self._ms = self._query.elapsed * 1e-6
        if self._ms is None:
            raise UmbrageError("no GPU time was measured")
        return self._ms
