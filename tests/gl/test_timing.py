"""GPU time: measured on this machine, queried on hardware, never nested."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer.core.errors import UmbrageError
from renderer.gl.context import GL
from renderer.gl.source import assemble
from renderer.gl.targets import Target, run_fullscreen
from renderer.gl.thread import GLThread
from renderer.gl.timing import GpuTimer


def test_on_a_software_rasteriser_the_queue_is_drained_on_both_sides(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock that only drained work advances: 2 ms queued before, 5 ms within, of which 5 must be told."""
    clock = {"now": 1.0, "queued": 2e-3}

    def finish() -> None:
        clock["now"] += clock["queued"]
        clock["queued"] = 0.0
    monkeypatch.setattr("renderer.gl.timing.time.perf_counter", lambda: clock["now"])
    ctx: Any = SimpleNamespace(finish=finish)
    with GpuTimer(ctx, software=True).measure() as measured:
        clock["queued"] += 5e-3
    assert np.isclose(measured.ms, 5.0)


def test_real_work_has_a_cost_on_this_machine(thread: GLThread) -> None:
    body = "layout(location = 0) out vec4 o; void main() { float x = 0.0;" \
           "for (int i = 0; i < rounds; i++) x = fract(sin(x + float(i))); o = vec4(x); }"

    def job(gl: GL) -> float:
        target = Target(gl, 128, 128)
        with gl.timer().measure() as measured:
            target.use()
            run_fullscreen(gl, assemble([], declarations="uniform int rounds;", body=body), {}, {"rounds": 50})
        target.release()
        return measured.ms
    assert thread.call(job) > 0


def test_the_number_is_known_only_when_measured(thread: GLThread) -> None:
    def job(gl: GL) -> None:
        timer = GpuTimer(gl.ctx, gl.info.software)
        with pytest.raises(UmbrageError, match="no GPU time"):
            _ = timer.ms
        with timer.measure():
            with pytest.raises(UmbrageError, match="do not nest"), timer.measure():
                pass
            with pytest.raises(UmbrageError, match="when the measurement is over"):
                _ = timer.ms
        assert timer.ms == timer.ms >= 0
    thread.call(job)


def test_a_measurement_that_fails_does_not_block_the_next(thread: GLThread) -> None:
    def job(gl: GL) -> float:
        with pytest.raises(ZeroDivisionError), gl.timer().measure():
            _ = 1 // 0
        with pytest.raises(UmbrageError, match="no GPU time"):
            _ = gl.timer().ms
        with gl.timer().measure() as measured:
            pass
        return measured.ms
    assert thread.call(job) >= 0


def test_on_hardware_the_query_s_nanoseconds_are_asked_for_once() -> None:
    class Query:
        asked = 0

        def __enter__(self) -> Query:
            return self

        def __exit__(self, *_: object) -> None:
            pass

        @property
        def elapsed(self) -> int:
            Query.asked += 1
            return 2_500_000
    ctx: Any = SimpleNamespace(query=lambda time: Query())
    timer = GpuTimer(ctx, software=False)
    with timer.measure() as measured:
        pass
    assert np.isclose(measured.ms, 2.5)
    assert np.isclose(measured.ms, 2.5)
    assert Query.asked == 1
