"""Other threads of Python go on while a picture is drawn."""

from __future__ import annotations

import itertools
import time

import pytest

from renderer.gl import waiting
from renderer.gl.context import GL
from renderer.gl.source import assemble
from renderer.gl.targets import Target, run_fullscreen
from renderer.gl.thread import GLThread

SLOW = """
out vec4 colour;
uniform float seed;
void main() {
    float x = seed + gl_FragCoord.x;
    for (int i = 0; i < 3000; i++) x = sin(x) * 1.7 + cos(x * 1.3);
    colour = vec4(x);
}
"""


def longest_stop(thread: GLThread) -> float:
    """Longest time in which this thread could not run while a picture was drawn, as a share of the drawing."""
    def job(gl: GL) -> None:
        target = Target(gl, 384, 384)
        target.use()
        run_fullscreen(gl, assemble([], body=SLOW), {}, {"seed": 0.5})
        target.read()
        target.release()
    drawing = thread.submit(job)
    seen = [time.perf_counter()]
    while not drawing.done():
        time.sleep(1e-3)
        seen.append(time.perf_counter())
    return max(b - a for a, b in itertools.pairwise(seen)) / (seen[-1] - seen[0])


def test_python_goes_on_while_a_picture_is_drawn(thread: GLThread, monkeypatch: pytest.MonkeyPatch) -> None:
    longest_stop(thread)  # compiles the program, which nothing but the driver can do
    assert longest_stop(thread) < 0.5
    with monkeypatch.context() as patch:
        patch.setattr("renderer.gl.context.finisher", lambda: waiting._nothing)
        with GLThread("stopping") as spoiled:
            if spoiled.info.software:
                longest_stop(spoiled)
                assert longest_stop(spoiled) > 0.5, "without giving up the lock everything stops"


def test_without_the_library_it_waits_for_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(waiting, "LIBRARY", "no such library")
    assert waiting.finisher() is waiting._nothing
