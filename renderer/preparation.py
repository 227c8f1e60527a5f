"""Bakes on their way to the memory of a session."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass

from renderer.core.technique import Arrays
from renderer.core.work import Task


@dataclass(frozen=True)
class Preparation:
    """Bakes on their way.

    Attributes:
        future: done when the state may be drawn.
        cancel: drops this holder's interest; the work itself goes on while somebody else wants it.
    """

    future: Future[None]
    cancel: Callable[[], None]


def following(task: Task[dict[str, Arrays]], keep: Callable[[dict[str, Arrays]], None]) -> Preparation:
    """The preparation that is over when a task is, and its results are kept.

    Args:
        task: computes the bakes.
        keep: receives their arrays by name, before anybody hears that they are there.
    """
    done: Future[None] = Future()

    def settle(finished: Future[dict[str, Arrays]]) -> None:
        failure = None if finished.cancelled() else finished.exception()
        if finished.cancelled():
            done.cancel()
        elif failure is not None:
            done.set_exception(failure)
        else:
            keep(finished.result())
            done.set_result(None)

    task.future.add_done_callback(settle)
    return Preparation(done, task.cancel)
