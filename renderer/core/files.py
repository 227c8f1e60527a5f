"""Files that several processes share: written whole or not at all, and locked across processes."""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import BinaryIO

TEMPORARY = ".writing-"
"""Start of the name of a file that is still being written."""

GRACE_S = 60.0
"""Age below which an unlocked temporary file is left alone: its writer may not have locked it yet."""


def write_atomically(path: Path, write: Callable[[BinaryIO], None]) -> None:
    """Write a file that other processes see whole or not at all.

    The bytes reach the disk before the name does, so that a power cut leaves the old file or the new one. The temporary
    file stays locked while it is written: an unlocked one belongs to a killed writer (`sweep`).

    Args:
        path: the file; its folder is made.
        write: called once with the open temporary file.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(prefix=TEMPORARY, dir=path.parent)
    with os.fdopen(handle, "wb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX)
            write(file)
            file.flush()
            os.fsync(file.fileno())
            os.replace(name, path)
        except BaseException:
            with contextlib.suppress(FileNotFoundError):
                os.unlink(name)
            raise
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def sweep(folder: Path) -> None:
    """Delete the temporary files that killed writers left under `folder`."""
    for path in folder.rglob(f"{TEMPORARY}*"):
        with contextlib.suppress(OSError), path.open("rb") as file:
            if time.time() - path.stat().st_mtime < GRACE_S:
                continue
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            path.unlink()


@contextlib.contextmanager
def locked(path: Path, waiting: Callable[[], None] | None = None, poll_s: float = 0.05) -> Iterator[None]:
    """Hold the lock named by `path` against other processes and threads; a killed holder lets go by dying.

    Args:
        path: the lock's file; it is made, and stays.
        waiting: called every `poll_s` seconds while somebody else holds the lock; may raise to give up.
        poll_s: s.
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("ab") as file:
        if waiting is None:
            fcntl.flock(file, fcntl.LOCK_EX)
        else:
            while True:
                try:
                    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    break
                except BlockingIOError:
                    waiting()
                    time.sleep(poll_s)
        yield
