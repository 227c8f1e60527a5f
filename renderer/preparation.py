"""Bakes on their way to the memory of a session."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Protocol

from renderer.core.registry import phenomenon
from renderer.core.technique import Arrays
from renderer.core.work import Task
from renderer.world.state import SceneState

COARSE_FIRST_S = 6.0
"""A bake that takes longer [s] is worth a coarse one before it."""


class Knowing(Protocol):
    """Who knows what is baked."""

    def prepared(self, state: SceneState) -> bool:
        """Whether a state can be drawn at once."""

    def expected_seconds(self, state: SceneState) -> float:
        """What baking it will take."""


def coarse_of(session: Knowing, state: SceneState) -> SceneState | None:
    """A state to show while another is baked, much sooner baked itself; None where there is none, or no need of one."""
    make = phenomenon(state.scene).coarse
    if make is None or session.prepared(state) or (long := session.expected_seconds(state)) < COARSE_FIRST_S:
        return None
    found: SceneState = make(state)
    return found if session.expected_seconds(found) < long / 2 else None


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
        if finished.cancelled():
            done.cancel()
            return
        failure = finished.exception()
        if failure is None:
            keep(finished.result())
        if not done.set_running_or_notify_cancel():
            return  # whoever waited for it has gone
        if failure is None:
            done.set_result(None)
        else:
            done.set_exception(failure)

    task.future.add_done_callback(settle)
    return Preparation(done, task.cancel)
