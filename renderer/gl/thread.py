"""The one thread that owns the OpenGL context."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field
from typing import Any, Concatenate, ParamSpec, TypeVar

import moderngl

from renderer.core.errors import GLThreadError
from renderer.gl.context import GL, GLError, GLInfo, GLLeak, create_context

__all__ = ["GL", "GLError", "GLInfo", "GLLeak", "GLThread"]

P = ParamSpec("P")
R = TypeVar("R")


@dataclass
class _Job:
    run: Callable[[GL], Any]
    future: Future[Any] = field(default_factory=Future)


class GLThread:
    """Creates and owns the context, runs jobs one at a time in the order in which their places were taken.

    A submitted job takes a place of its own. A mailbox has one place: a newer job posted to it before it starts
    replaces the older one and keeps its place: mailboxes take turns, and a job waits for at most one of each.
    A job that needs another's result is posted when that one's future is done.

    Raises:
        GLUnavailable: this machine has no usable OpenGL.
    """

    def __init__(self, name: str = "gl") -> None:
        self._changed = threading.Condition()
        self._queue: OrderedDict[object, _Job] = OrderedDict()
        self._closing = False
        self._failure: BaseException | None = None
        self._gl: GL | None = None
        self._live = 0
        started: Future[GLInfo] = Future()
        self._thread = threading.Thread(target=self._main, args=(started,), name=name, daemon=True)
        self._thread.start()
        self.info = started.result()

    @property
    def context(self) -> moderngl.Context:
        """The context, for code that runs on this thread.

        Raises:
            GLThreadError: the caller runs on another thread, or the context is closed.
        """
        if self._gl is None:
            raise GLThreadError("the OpenGL context is closed")
        return self._gl.ctx

    def submit(self, fn: Callable[Concatenate[GL, P], R], *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        """Run `fn(gl, *args)` on the thread, in its turn.

        Raises:
            GLThreadError: the thread is closed.
        """
        job = _Job(lambda gl: fn(gl, *args, **kwargs))
        self._place(object(), job)
        return job.future

    def post(self, mailbox: str, fn: Callable[Concatenate[GL, P], R], *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        """Run `fn(gl, *args)` in the mailbox's turn, unless a newer post to the mailbox comes before it starts.

        Returns:
            Its future; a job that was replaced has it cancelled.

        Raises:
            GLThreadError: the thread is closed.
        """
        job = _Job(lambda gl: fn(gl, *args, **kwargs))
        replaced = self._place(mailbox, job)
        if replaced is not None:
            _cancel(replaced)
        return job.future

    def call(self, fn: Callable[Concatenate[GL, P], R], *args: P.args, **kwargs: P.kwargs) -> R:
        """Run `fn(gl, *args)` and wait for its result; on the thread itself, at once.

        Raises:
            GLThreadError: the thread is closed.
            GLError: OpenGL refused a command.
        """
        if threading.current_thread() is self._thread and self._gl is not None:
            return fn(self._gl, *args, **kwargs)
        return self.submit(fn, *args, **kwargs).result()

    def live_objects(self) -> int:
        """How many GL objects are not released, programs of the cache included; 0 after a clean close."""
        if self._gl is None:
            return self._live
        return self.call(lambda gl: gl.live_objects().total())

    def close(self) -> None:
        """Run the submitted jobs, cancel the posted ones, release every owner and the context, join the thread.

        Closing again does nothing.

        Raises:
            GLThreadError: it was called on the thread itself, which cannot wait for its own end.
            GLLeak: GL objects were left that no owner released.
        """
        if threading.current_thread() is self._thread:
            raise GLThreadError("the GL thread cannot close itself: close it from the thread that made it")
        with self._changed:
            first = not self._closing
            self._closing = True
            posted = [key for key in self._queue if isinstance(key, str)]
            cancelled = [self._queue.pop(key) for key in posted]
            self._changed.notify()
        for job in cancelled:
            _cancel(job)
        self._thread.join()
        if first and self._failure is not None:
            raise self._failure

    def __enter__(self) -> GLThread:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _place(self, key: object, job: _Job) -> _Job | None:
        """Queue a job; returns the one whose place it took."""
        with self._changed:
            if self._closing:
                raise GLThreadError("the GL thread is closed")
            replaced = self._queue.get(key)
            self._queue[key] = job  # a key that is already there keeps its place
            self._changed.notify()
            return replaced

    def _main(self, started: Future[GLInfo]) -> None:
        try:
            self._gl = GL(create_context())
        except BaseException as failure:
            with self._changed:
                self._closing = True
            started.set_exception(failure)
            return
        started.set_result(self._gl.info)
        while (job := self._next()) is not None:
            if job.future.set_running_or_notify_cancel():
                _run(self._gl, job)
            del job  # an idle thread must not keep the last job's pictures alive
        try:
            self._gl.close()
        except BaseException as failure:
            self._failure = failure
        self._live = self._gl.left
        self._gl = None

    def _next(self) -> _Job | None:
        with self._changed:
            while not self._queue and not self._closing:
                self._changed.wait()
            return self._queue.popitem(last=False)[1] if self._queue else None


def _cancel(job: _Job) -> None:
    job.future.cancel()
    job.future.set_running_or_notify_cancel()  # wakes those who wait for it


def _run(gl: GL, job: _Job) -> None:
    """Run one job from a clean pipeline state, and resolve its future whatever happens."""
    try:
        gl.reset()
        result = job.run(gl)
        gl.check()
    except BaseException as failure:
        job.future.set_exception(failure)
    else:
        job.future.set_result(result)
