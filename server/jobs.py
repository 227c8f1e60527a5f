"""Long work asked over HTTP: a bounded queue with progress, cancellation, and results that are kept for a while."""

from __future__ import annotations

import asyncio
import functools
import secrets
import threading
import time
from collections.abc import Callable
from concurrent.futures import CancelledError, ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, Literal

from renderer.core.errors import Cancelled
from server.metrics import Metrics
from server.problems import Busy, Missing, said
from server.settings import Settings

Status = Literal["queued", "running", "done", "failed", "cancelled"]
CLOSE_S = 1.0
"""How long running work may take to notice that the server ends."""
KEPT_BYTES = 1 << 30
"""Results kept in memory, all together; the newest is kept whatever its size."""
OVER: frozenset[Status] = frozenset({"done", "failed", "cancelled"})


@dataclass(frozen=True)
class Result:
    """What a job leaves: files as bytes by name, and numbers."""

    files: dict[str, bytes] = field(default_factory=dict)
    numbers: dict[str, Any] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """Of its files, bytes."""
        return sum(len(data) for data in self.files.values())


class Job:
    """One piece of long work; `advance` is its progress callback and is where it notices that it was cancelled."""

    def __init__(self, kind: str) -> None:
        self.id = secrets.token_urlsafe(12)
        self.kind = kind
        self.status: Status = "queued"
        self.fraction = 0.0
        self.words = "waiting for its turn"
        self.seconds_left: float | None = None
        self.result: Result | None = None
        self.errors: list[dict[str, str]] = []
        self.ended: float | None = None
        self.task: asyncio.Task[None] | None = None
        self._stop = threading.Event()
        self._stoppers: list[Callable[[], None]] = []

    def advance(self, progress: Any) -> None:
        """Note the progress; called from the thread that works.

        Raises:
            Cancelled: nobody wants the result any more.
        """
        if self._stop.is_set():
            raise Cancelled("the job was cancelled")
        self.fraction = max(0.0, min(1.0, float(progress.fraction)))
        self.words = str(progress.words)
        self.seconds_left = progress.seconds_left

    def stop(self) -> None:
        """Ask the work to end at its next progress report."""
        self._stop.set()
        for stop in self._stoppers:
            stop()

    def on_stop(self, stop: Callable[[], None]) -> None:
        """Have `stop` called when the job is cancelled, or now if it already was; it may be called twice."""
        self._stoppers.append(stop)
        if self._stop.is_set():
            stop()

    def document(self) -> dict[str, Any]:
        """The job as the doors show it."""
        shown: dict[str, Any] = {
            "id": self.id,
            "kind": self.kind,
            "status": self.status,
            "fraction": self.fraction,
            "words": self.words,
            "seconds_left": self.seconds_left,
        }
        if self.errors:
            shown["errors"] = self.errors
        if self.result is not None:
            files = {name: f"/api/jobs/{self.id}/files/{name}" for name in self.result.files}
            shown["result"] = {"files": files, **self.result.numbers}
        return shown


class Jobs:
    """The queue of one server.

    Args:
        settings: how many wait and run, and how long results are kept.
        metrics: counters.
    """

    def __init__(self, settings: Settings, metrics: Metrics) -> None:
        self._settings, self._metrics = settings, metrics
        self._jobs: dict[str, Job] = {}
        self._slots = asyncio.Semaphore(settings.jobs_running)
        self._threads = ThreadPoolExecutor(settings.jobs_running, "job")

    def list(self) -> list[Job]:
        """Jobs that are known, the newest last."""
        self._forget()
        return list(self._jobs.values())

    def get(self, number: str) -> Job:
        """The job with this id.

        Raises:
            Missing: there is none, or its result expired.
        """
        self._forget()
        if number not in self._jobs:
            raise Missing("id", "there is no such job; results are forgotten after a while")
        return self._jobs[number]

    def unfinished(self) -> int:
        """How many wait or run."""
        return sum(job.status not in OVER for job in self._jobs.values())

    def start(self, kind: str, work: Callable[[Job], Result]) -> Job:
        """Queue `work`, which runs in a thread and reports to `Job.advance`.

        Raises:
            Busy: the queue is full.
        """
        self._forget()
        if self.unfinished() >= self._settings.jobs:
            raise Busy("", "too many jobs are waiting", f"{self._settings.jobs} at once")
        job = Job(kind)
        self._jobs[job.id] = job
        job.task = asyncio.create_task(self._run(job, work))
        return job

    def cancel(self, job: Job) -> None:
        """Cancel a waiting or running job, or forget the result of one that is over."""
        job.stop()
        if job.status == "queued" and job.task is not None:
            job.task.cancel()
        elif job.status in OVER:
            self._jobs.pop(job.id, None)

    async def close(self) -> None:
        """Cancel everything; work that does not notice in time ends with the session, which is closed next."""
        tasks = [job.task for job in self._jobs.values() if job.task is not None and not job.task.done()]
        for job in list(self._jobs.values()):
            if job.status not in OVER:
                self.cancel(job)
        if tasks:
            await asyncio.wait(tasks, timeout=CLOSE_S)
        self._threads.shutdown(wait=False, cancel_futures=True)

    async def _run(self, job: Job, work: Callable[[Job], Result]) -> None:
        outcome: Status = "cancelled"
        try:
            async with self._slots:
                job.status, job.words = "running", "starting"
                loop = asyncio.get_running_loop()
                job.result = await loop.run_in_executor(self._threads, functools.partial(work, job))
            outcome, job.fraction, job.words, job.seconds_left = "done", 1.0, "done", 0.0
        except (Cancelled, CancelledError, asyncio.CancelledError):
            job.words = "cancelled"
        except Exception as failure:  # told in the job's document; unexpected ones are logged
            outcome, job.errors, job.words = "failed", said(failure), "failed"
        job.status, job.ended = outcome, time.monotonic()
        self._metrics.jobs.labels(job.kind, outcome).inc()

    def _forget(self) -> None:
        """Drop results that are older than they are kept, and of the rest the oldest beyond so many or so much."""
        now = time.monotonic()
        over = [job for job in self._jobs.values() if job.ended is not None]
        over.sort(key=lambda job: job.ended or 0.0, reverse=True)
        held = 0
        for index, job in enumerate(over):
            held += job.result.size if job.result is not None else 0
            surplus = index >= self._settings.jobs or (index > 0 and held > KEPT_BYTES)
            if surplus or now - (job.ended or now) > self._settings.jobs_kept:
                del self._jobs[job.id]
