"""The thread that owns the context: order, mailboxes, errors, guards, and a close that leaves nothing."""

from __future__ import annotations

import threading
from collections.abc import Callable
from concurrent.futures import Future, wait
from typing import Any

import moderngl
import pytest

from renderer.core.errors import GLThreadError, GLUnavailable, UmbrageError
from renderer.gl.context import GL, GLError, GLLeak
from renderer.gl.thread import GLThread

WAIT = 30.0  # seconds after which a test is stuck, far above what any of these takes


class Gate:
    """Holds the thread in a job until it is opened, so that a queue can build up behind it."""

    def __init__(self, thread: GLThread) -> None:
        self._open = threading.Event()
        entered = threading.Event()

        def hold(gl: GL) -> None:
            entered.set()
            assert self._open.wait(WAIT)
        self.job = thread.submit(hold)
        assert entered.wait(WAIT)

    def open(self) -> None:
        self._open.set()


def note(log: list[str], word: str) -> Callable[[GL], str]:
    def job(gl: GL) -> str:
        log.append(word)
        return word
    return job


def test_the_machine_is_described_and_new_enough(thread: GLThread) -> None:
    assert thread.info.version >= (3, 3)
    assert thread.info.renderer
    assert thread.info.vendor
    assert thread.info.software == ("llvmpipe" in thread.info.renderer or "soft" in thread.info.renderer.lower())


def test_submitted_jobs_run_in_order_on_one_other_thread(thread: GLThread) -> None:
    gate, log = Gate(thread), []
    jobs = [thread.submit(note(log, str(number))) for number in range(20)]
    names = thread.submit(lambda gl: threading.current_thread().name)
    gate.open()
    assert [job.result(WAIT) for job in jobs] == [str(number) for number in range(20)] == log
    assert names.result(WAIT) == "gl" != threading.current_thread().name


def test_a_mailbox_keeps_only_its_newest_job(thread: GLThread) -> None:
    gate, log = Gate(thread), []
    posts = [thread.post("view", note(log, str(number))) for number in range(5)]
    gate.open()
    assert posts[-1].result(WAIT) == "4"
    assert all(post.cancelled() for post in posts[:-1])
    assert log == ["4"]


def test_waiting_for_a_replaced_job_ends_when_it_is_replaced(thread: GLThread) -> None:
    gate = Gate(thread)
    old = thread.post("view", note([], "old"))
    new = thread.post("view", note([], "new"))
    done, pending = wait([old], timeout=WAIT)
    assert (done, pending) == ({old}, set())
    gate.open()
    assert new.result(WAIT) == "new"


def test_two_mailboxes_take_turns_however_often_one_posts(thread: GLThread) -> None:
    """A view that posts again from each of its frames gets every second turn, not all of them."""
    log: list[str] = []
    left = {"a": 6, "b": 6}
    over = {name: threading.Event() for name in left}

    def frame(name: str) -> Callable[[GL], None]:
        def job(gl: GL) -> None:
            log.append(name)
            left[name] -= 1
            if left[name]:
                for _ in range(3):  # a burst of newer states
                    thread.post(name, frame(name))
            else:
                over[name].set()
        return job
    gate = Gate(thread)
    for name in left:
        thread.post(name, frame(name))
    gate.open()
    assert all(event.wait(WAIT) for event in over.values())
    assert "".join(log) == "ab" * 6


def test_a_busy_mailbox_does_not_starve_submitted_jobs_nor_they_it(thread: GLThread) -> None:
    gate, log = Gate(thread), []
    thread.post("view", note(log, "v1"))
    first = thread.submit(note(log, "s1"))
    thread.post("view", note(log, "v2"))  # keeps the place of v1
    last = thread.submit(note(log, "s2"))
    gate.open()
    assert first.result(WAIT) == "s1"
    assert last.result(WAIT) == "s2"
    assert log == ["v2", "s1", "s2"]


def test_a_failing_job_gives_its_error_and_the_thread_lives_on(thread: GLThread) -> None:
    def fail(gl: GL) -> None:
        raise UmbrageError("this one fails")
    with pytest.raises(UmbrageError, match="this one fails"):
        thread.call(fail)
    assert thread.call(lambda gl: 7) == 7


def test_a_job_cancelled_before_its_turn_does_not_run(thread: GLThread) -> None:
    gate, log = Gate(thread), []
    job = thread.submit(note(log, "no"))
    assert job.cancel()
    gate.open()
    assert thread.call(lambda gl: log) == []


def test_an_opengl_error_is_the_error_of_its_own_job(thread: GLThread) -> None:
    def wrong(gl: GL) -> None:
        gl.ctx.viewport = 0, 0, -1, -1
    with pytest.raises(GLError, match="GL_INVALID_VALUE"):
        thread.call(wrong)
    assert thread.call(lambda gl: gl.ctx.error) == "GL_NO_ERROR"


def test_a_job_finds_the_switches_off_whatever_the_one_before_did(thread: GLThread) -> None:
    def leave_on(gl: GL) -> None:
        gl.ctx.enable(moderngl.BLEND | moderngl.DEPTH_TEST | moderngl.CULL_FACE)
        gl.ctx.blend_func = moderngl.ONE, moderngl.ONE
    thread.call(leave_on)
    source = "#version 330\nvoid main() {" \
             "gl_Position = vec4(vec2(gl_VertexID % 2, gl_VertexID / 2) * 4.0 - 1.0, 0, 1); }"
    fill = "#version 330\nout vec4 o; void main() { o = vec4(0.25); }"

    def draw_twice(gl: GL) -> bytes:
        texture = gl.ctx.texture((1, 1), 4, dtype="f4")
        target = gl.ctx.framebuffer([texture])
        program = gl.ctx.program(vertex_shader=source, fragment_shader=fill)
        array = gl.ctx.vertex_array(program, [])
        target.use()
        for _ in range(2):
            array.render(moderngl.TRIANGLES, vertices=3)
        read = bytes(target.read(components=1, dtype="f4"))
        for made in (array, program, target, texture):
            made.release()
        return read
    assert thread.call(draw_twice) == b"\x00\x00\x80\x3e"  # 0.25 once, not added twice


def test_the_context_is_refused_to_other_threads(thread: GLThread) -> None:
    gl = thread.call(lambda gl: gl)
    with pytest.raises(GLThreadError, match="MainThread"):
        gl.ctx  # noqa: B018 - reading it is the offence
    with pytest.raises(GLThreadError, match="MainThread"):
        thread.context  # noqa: B018
    assert thread.call(lambda gl: thread.context is gl.ctx)


def test_a_call_from_the_thread_itself_runs_at_once(thread: GLThread) -> None:
    assert thread.call(lambda gl: thread.call(lambda inner: inner is gl))
    with pytest.raises(GLThreadError, match="close itself"):
        thread.call(lambda gl: thread.close())


def test_a_clean_close_leaves_no_object_and_no_thread() -> None:
    running = GLThread("gl-clean")

    def make(gl: GL) -> list[Any]:
        texture = gl.ctx.texture((2, 2), 4)
        return [gl.ctx.buffer(reserve=4), gl.ctx.framebuffer([texture]), texture]
    made = running.call(make)
    assert running.live_objects() == 3
    running.call(lambda gl: [thing.release() for thing in made])
    running.close()
    assert running.live_objects() == 0
    assert not any(thread.name == "gl-clean" for thread in threading.enumerate())


def test_an_owner_is_released_before_the_context() -> None:
    class Owner:
        def __init__(self, gl: GL) -> None:
            self.buffer = gl.ctx.buffer(reserve=4)
            gl.at_close(self)

        def release(self) -> None:
            self.buffer.release()
    running = GLThread()
    running.call(Owner)
    assert running.live_objects() == 1
    running.close()
    assert running.live_objects() == 0


def test_a_leak_is_reported_by_type_and_the_thread_still_ends() -> None:
    running = GLThread("gl-leaking")
    running.call(lambda gl: gl.ctx.buffer(reserve=4).size)
    running.call(lambda gl: gl.ctx.texture((2, 2), 4).size)
    with pytest.raises(GLLeak, match="1 Buffer, 1 Texture"):
        running.close()
    assert running.live_objects() == 2
    assert not any(thread.name == "gl-leaking" for thread in threading.enumerate())
    running.close()  # again: nothing left to do or to say


def test_closing_runs_what_was_submitted_and_cancels_what_was_posted() -> None:
    running, log = GLThread(), []
    gate = Gate(running)
    submitted = running.submit(note(log, "submitted"))
    posted = running.post("view", note(log, "posted"))
    closer = threading.Thread(target=running.close)
    closer.start()
    assert wait([posted], timeout=WAIT).done == {posted}
    gate.open()
    closer.join(WAIT)
    assert submitted.result(WAIT) == "submitted"
    assert posted.cancelled()
    assert log == ["submitted"]
    for door in (running.submit, lambda job: running.post("view", job), running.call):
        with pytest.raises(GLThreadError, match="closed"):
            door(note(log, "late"))
    with pytest.raises(GLThreadError, match="closed"):
        running.context  # noqa: B018


def test_releasing_the_framebuffer_in_use_spoils_nothing_that_follows(thread: GLThread) -> None:
    """moderngl binds the last one again after making another; once that failed with GL_INVALID_OPERATION."""
    def job(gl: GL) -> None:
        for _ in range(2):
            texture = gl.ctx.texture((2, 2), 4)
            framebuffer = gl.ctx.framebuffer([texture])
            framebuffer.use()
            framebuffer.release()
            texture.release()
    thread.call(job)


def test_what_a_technique_requires_is_checked_against_the_machine(thread: GLThread) -> None:
    thread.call(lambda gl: gl.require((3, 3), "the forest"))
    with pytest.raises(GLUnavailable, match=r"the lists requires OpenGL 9\.9; this machine has"):
        thread.call(lambda gl: gl.require((9, 9), "the lists"))


def test_results_of_many_threads_stay_their_own(thread: GLThread) -> None:
    results: dict[int, list[Any]] = {}

    def client(number: int) -> None:
        jobs: list[Future[int]] = [thread.submit(lambda gl, n=n: number * 100 + n) for n in range(50)]
        results[number] = [job.result(WAIT) for job in jobs]
    clients = [threading.Thread(target=client, args=(number,)) for number in range(4)]
    for one in clients:
        one.start()
    for one in clients:
        one.join(WAIT)
    assert results == {number: [number * 100 + n for n in range(50)] for number in range(4)}
