"""How a worker process reports progress and learns that its work is no longer wanted.

Small files in a shared folder: they need no connection between the two processes, survive the death of either, and
work the same for a local pool and for a cluster that shares the cache's folder.
"""

from __future__ import annotations

import contextlib
import json
import time
import uuid
from dataclasses import asdict, dataclass
from pathlib import Path

from renderer.core.errors import Cancelled

REPORT_EVERY_S = 0.1
"""Reports closer together than this are dropped: nobody sees them, and each costs a file."""

STALE_S = 86400.0
"""Age above which a channel's files are a dead process's."""


@dataclass(frozen=True)
class Progress:
    """How far long work is.

    Attributes:
        name: what is being computed now, as a bake's name.
        fraction: share of the whole that is done, in [0, 1]; never falls.
        words: what is happening, for people.
        seconds_left: expected time to the end of the whole, s.
    """

    name: str
    fraction: float
    words: str
    seconds_left: float


class Channel:
    """One piece of work's mailbox, seen from both processes.

    Args:
        folder: shared by both.
        name: tells apart the pieces of work that share a folder; made up when absent.
    """

    def __init__(self, folder: Path, name: str | None = None) -> None:
        self.folder = folder
        self.name = name or uuid.uuid4().hex
        self._reported = 0.0

    def report(self, progress: Progress) -> None:
        """Tell the owner how far the work is.

        Raises:
            Cancelled: the owner no longer wants it.
        """
        now = time.monotonic()
        if now - self._reported < REPORT_EVERY_S:
            return
        self._reported = now
        if self._cancel.exists():
            raise Cancelled(f"{progress.name} was cancelled")
        self.folder.mkdir(parents=True, exist_ok=True)
        fresh = self._progress.with_suffix(".fresh")
        fresh.write_text(json.dumps(asdict(progress)))
        fresh.replace(self._progress)

    def latest(self) -> Progress | None:
        """The last report, or None before the first."""
        try:
            return Progress(**json.loads(self._progress.read_text()))
        except FileNotFoundError:
            return None

    def cancel(self) -> None:
        """Ask the worker to stop at its next report."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._cancel.touch()

    def close(self) -> None:
        """Remove the channel's files, and those that dead processes left."""
        for path in (self._progress, self._cancel, self._progress.with_suffix(".fresh")):
            path.unlink(missing_ok=True)
        for path in self.folder.glob("*.*"):
            with contextlib.suppress(FileNotFoundError):
                if time.time() - path.stat().st_mtime > STALE_S:
                    path.unlink()

    @property
    def _progress(self) -> Path:
        return self.folder / f"{self.name}.progress"

    @property
    def _cancel(self) -> Path:
        return self.folder / f"{self.name}.cancel"
