"""The process that opens strangers' files: started by `upload`, it reads one task, answers in JSON and ends.

Only the standard library is imported before `confine`: every library that touches the file loads under the limits.
"""

from __future__ import annotations

import json
import math
import os
import resource
import sys
from pathlib import Path
from typing import Any


def confine(memory_bytes: int, seconds: float) -> None:
    """Give up, for good, what opening a file does not need: memory, time, files to write and core dumps.

    Args:
        memory_bytes: address space. seconds: processor time.
    """
    for what, most in (
        (resource.RLIMIT_AS, memory_bytes),
        (resource.RLIMIT_CPU, math.ceil(seconds) + 1),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
        (resource.RLIMIT_NOFILE, 64),
    ):
        _, hard = resource.getrlimit(what)
        limit = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(what, (limit, limit))


def answer(task: dict[str, Any]) -> dict[str, Any]:
    """The preview of the task's file, or its error."""
    from renderer.core.errors import InputError, InvalidDocument, LimitError
    from renderer.world.limits import Limits
    from renderer.world.upload_preview import PREVIEWS

    try:
        limits = Limits.model_validate(task["limits"])
        return {"preview": PREVIEWS[task["kind"]](Path(task["path"]), limits, task["reading"])}
    except InvalidDocument as invalid:
        return {"error": invalid.errors[0].as_dict()}
    except InputError as error:
        return {"error": error.as_dict(), "limit": isinstance(error, LimitError)}
    except MemoryError:
        most = f"{task['limits']['worker_bytes'] >> 20} MB"
        greedy = LimitError("file", "needs more memory than a file may take", most)
        return {"error": greedy.as_dict(), "limit": True}


def main() -> None:
    """Read the task from standard input and answer on what was standard output."""
    # Libraries that write to standard output must not write into the answer.
    channel = os.dup(1)
    os.dup2(2, 1)
    task = json.load(sys.stdin)
    confine(task["limits"]["worker_bytes"], task["limits"]["worker_seconds"])
    os.write(channel, json.dumps(answer(task), allow_nan=False).encode())


if __name__ == "__main__":
    main()
