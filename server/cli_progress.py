"""Progress of long work on the terminal."""

from __future__ import annotations

import sys
import time
from typing import Any, TextIO

WIDTH = 24
QUIET_S = 5.0
"""Where stderr is no terminal, one line in so many seconds."""


class Bar:
    """A progress callback that draws a bar on stderr, or writes lines where that is a file.

    Args:
        stream: where to.
    """

    def __init__(self, stream: TextIO = sys.stderr) -> None:
        self._stream = stream
        self._drawn = False
        self._at = -QUIET_S

    def __call__(self, progress: Any) -> None:
        """Show how far the work is; called from any thread."""
        left = "" if progress.seconds_left is None else f", {progress.seconds_left:.0f} s left"
        words = f"{progress.name}: {progress.words}{left}"
        if self._stream.isatty():
            full = round(WIDTH * progress.fraction)
            self._stream.write(f"\r[{'#' * full}{'.' * (WIDTH - full)}] {progress.fraction:4.0%} {words}\x1b[K")
            self._drawn = True
        elif time.monotonic() - self._at >= QUIET_S:
            self._at = time.monotonic()
            self._stream.write(f"{progress.fraction:4.0%} {words}\n")
        self._stream.flush()

    def close(self) -> None:
        """End the bar's line."""
        if self._drawn:
            self._stream.write("\r\x1b[K")
            self._stream.flush()
