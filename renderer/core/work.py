"""Bakes in worker processes, with progress and cancellation, so that no session's frames stop for another's bake."""

from __future__ import annotations

import contextlib
import logging
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from multiprocessing.connection import Connection
from typing import Generic, TypeVar

from renderer.core.baking import Report, bake_key, bake_now, expected_seconds, gather, missing
from renderer.core.cache import Cache
from renderer.core.channel import Channel, Progress
from renderer.core.errors import Cancelled, UmbrageError
from renderer.core.technique import Arrays, Bake

__all__ = ["Progress", "Report", "Task", "Workers", "bake_key", "bake_now", "expected_seconds", "missing"]

POLL_S = 0.1
"""How often a running job's progress is read: as often as a worker writes it."""

CLOSE_S = 2.0
"""How long cancelled work may take to stop by itself when everything closes."""

T = TypeVar("T")
log = logging.getLogger(__name__)


class Task(Generic[T]):
    """Somebody's interest in a job.

    Attributes:
        future: the result, or why there is none: `Cancelled`, or an `UmbrageError` in words.
    """

    def __init__(self, job: _Job, pick: Callable[[dict[str, Arrays]], T], on_progress: Report | None) -> None:
        self.future: Future[T] = Future()
        # Marked as running, so that an asyncio task awaiting it cannot cancel it behind the job's back.
        self.future.set_running_or_notify_cancel()
        self._job = job
        self._pick = pick
        self._on_progress = on_progress

    def cancel(self) -> None:
        """Lose interest. The work itself stops at its next report, unless somebody else wants it too."""
        if self._job.leave(self):
            self.future.set_exception(Cancelled("the work was cancelled"))

    def _deliver(self, result: dict[str, Arrays]) -> None:
        self.future.set_result(self._pick(result))

    def _tell(self, progress: Progress) -> None:
        if self._on_progress is None:
            return
        try:
            self._on_progress(progress)
        except Cancelled:
            self.cancel()
        except Exception:
            log.exception("a listener to progress failed")


class _Job:
    """Some bakes being computed, for everybody who asked for exactly these; followed by a thread of its own."""

    def __init__(self, workers: Workers, bakes: tuple[Bake, ...], cache: Cache) -> None:
        self.key = (str(cache.folder), *(bake_key(bake) for bake in bakes))
        self.tasks: list[Task[dict[str, Arrays]] | Task[Arrays]] = []
        self._workers = workers
        self._bakes = bakes
        self._cache = cache
        self._channel = Channel(cache.folder / "work")
        self._running: Future[None] | None = None
        self._told: Progress | None = None
        self.thread = threading.Thread(target=self._follow, name="bake", daemon=True)

    def leave(self, task: Task[T]) -> bool:
        """Take a task off the job, which stops when it was the last; False when the job is already over for it."""
        with self._workers.lock:
            if task not in self.tasks:
                return False
            self.tasks.remove(task)  # type: ignore[arg-type]
            if not self.tasks:
                self._workers.forget(self)
                self._channel.cancel()
                if self._running is not None:
                    self._running.cancel()
        return True

    def _follow(self) -> None:
        failure: BaseException | None = None
        try:
            result = self._result()
        except BaseException as raised:
            failure = raised
        self._channel.close()
        with self._workers.lock:
            self._workers.forget(self)
            tasks, self.tasks = self.tasks, []
        for task in tasks:
            if failure is None:
                task._deliver(result)
            else:
                task.future.set_exception(failure)

    def _result(self) -> dict[str, Arrays]:
        if missing(self._bakes, self._cache):
            self._compute()
        result: dict[str, Arrays] = {}
        for bake in self._bakes:
            arrays = self._cache.get(bake_key(bake))
            if arrays is None:
                raise UmbrageError(f"{bake.name} was computed, but the cache is too small to keep it")
            result[bake.name] = arrays
        return result

    def _compute(self) -> None:
        for last in (False, True):
            executor = self._workers.executor()
            try:
                with self._workers.lock:
                    if not self.tasks:
                        raise Cancelled("the work was cancelled")
                    self._running = executor.submit(_work, self._bakes, self._cache, self._channel)
                self._wait(self._running)
                return
            except CancelledError:
                raise Cancelled("the work was cancelled") from None
            except BrokenExecutor:
                # Another job's bake may have ended the process that they shared; one's own does it again.
                self._workers.discard(executor)
                if last:
                    raise UmbrageError(f"the process that computed {self._bakes[-1].name} ended unexpectedly, "
                                       "perhaps for want of memory, or of 'if __name__ == \"__main__\":' around what a "
                                       "script does") from None

    def _wait(self, running: Future[None]) -> None:
        while True:
            over = bool(wait({running}, timeout=POLL_S).done)
            progress = self._channel.latest()
            if progress is not None and progress != self._told:
                self._told = progress
                with self._workers.lock:
                    tasks = list(self.tasks)
                for task in tasks:
                    task._tell(progress)
            if over:
                running.result()
                return


class Workers:
    """Computes bakes in other processes.

    Args:
        executor: where, as a Dask cluster's `client.get_executor()`; its machines must share the cache's folder.
            By default spawned processes of this machine, started when first needed.
        processes: how many of these.
    """

    def __init__(self, executor: Executor | None = None, processes: int = 1) -> None:
        self.lock = threading.Lock()
        self._given = executor
        self._processes = processes
        self._own: ProcessPoolExecutor | None = None
        self._alive: Connection | None = None
        self._jobs: dict[tuple[str, ...], _Job] = {}
        self._threads: set[threading.Thread] = set()
        self._closed = False

    def run(self, bake: Bake, cache: Cache, on_progress: Report | None = None) -> Task[Arrays]:
        """Compute one bake, its inputs first where they are missing.

        Args:
            bake: what; asked for twice at once, it is computed once.
            cache: where results are looked up and kept.
            on_progress: told how far the whole is, from another thread; may raise `Cancelled`.
        """
        return self._start((bake,), cache, lambda result: result[bake.name], on_progress)

    def run_all(self, bakes: Iterable[Bake], cache: Cache,
                on_progress: Report | None = None) -> Task[dict[str, Arrays]]:
        """Compute several bakes as one task with one progress; its result holds their arrays by name."""
        return self._start(tuple(bakes), cache, lambda result: result, on_progress)

    def _start(self, bakes: tuple[Bake, ...], cache: Cache, pick: Callable[[dict[str, Arrays]], T],
               on_progress: Report | None) -> Task[T]:
        fresh = _Job(self, bakes, cache)
        with self.lock:
            if self._closed:
                raise UmbrageError("the workers are closed")
            job = self._jobs.setdefault(fresh.key, fresh)
            task = Task(job, pick, on_progress)
            job.tasks.append(task)  # type: ignore[arg-type]
            if job is fresh:
                self._threads = {thread for thread in self._threads if thread.is_alive()} | {job.thread}
                job.thread.start()
        return task

    def forget(self, job: _Job) -> None:
        """Let the next request for the job's bakes start afresh; the caller holds the lock."""
        if self._jobs.get(job.key) is job:
            del self._jobs[job.key]

    def executor(self) -> Executor:
        """The executor in use; local processes are started here.

        Raises:
            Cancelled: the workers are closed.
            UmbrageError: this machine starts no processes.
        """
        with self.lock:
            if self._closed:
                raise Cancelled("the workers are closed")
            if self._given is not None:
                return self._given
            if self._own is None:
                ours, theirs = multiprocessing.Pipe()
                self._alive = ours
                spawn = multiprocessing.get_context("spawn")
                try:
                    self._own = ProcessPoolExecutor(self._processes, spawn, _settle, (theirs,))
                except OSError as failure:
                    # Semaphores live in shared memory, which a jail may lack.
                    raise UmbrageError(f"worker processes cannot be started here: {failure}") from failure
            return self._own

    def discard(self, executor: Executor) -> None:
        """Give up local processes that broke, so that the next job gets fresh ones."""
        with self.lock:
            if executor is self._own:
                self._own = None
        executor.shutdown(wait=False, cancel_futures=True)

    def close(self) -> None:
        """Cancel everything, end the local processes and join every thread."""
        with self.lock:
            self._closed = True
            jobs, threads = list(self._jobs.values()), list(self._threads)
        for job in jobs:
            for task in list(job.tasks):
                task.cancel()
        for thread in threads:
            thread.join(CLOSE_S)
        with self.lock:
            own, self._own, alive = self._own, None, self._alive
        if alive is not None:
            alive.close()
        if own is not None:
            own.shutdown(wait=True, cancel_futures=True)
        for thread in threads:
            thread.join()


def _settle(parent: Connection) -> None:
    """Make a fresh worker process polite: it yields to frames, leaves Ctrl-C to its parent, and ends with it."""
    with contextlib.suppress(OSError):
        os.nice(10)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with, args=(parent,), name="parent", daemon=True).start()


def _end_with(parent: Connection) -> None:
    with contextlib.suppress(EOFError, OSError):
        parent.recv()
    os._exit(0)


def _work(bakes: tuple[Bake, ...], cache: Cache, channel: Channel) -> None:
    """In the worker: leave the results in the cache, which the owner reads."""
    for _ in gather(bakes, cache, channel.report):
        pass
