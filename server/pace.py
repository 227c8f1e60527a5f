"""Keeps the pace of a live view: resolution while things move, and how many messages a client may send."""

from __future__ import annotations

import math
import statistics
from collections import deque
from typing import Any
from weakref import WeakKeyDictionary

LOWEST_SCALE = 0.5
"""Below it a picture looks poor: less only for as many pictures as a movement takes to look like one."""
COARSEST_SCALE = 0.375
SLOWEST_MS = 45.0
"""Frame time of 22 pictures a second."""
STEPS = 16
"""Scales are sixteenths: a renderer's targets are not made anew for every small change."""
HEADROOM = 0.9
"""A larger scale must leave a tenth of the frame time free, or the scale would swing between two steps."""
MOVING_S = 0.3
"""A view counts as moving for so long after a picture of its movement."""
REMEMBERED = 3
"""The cost is the median of three frames: one slow frame (a compilation) costs no resolution, two do."""


class ScaleController:
    """Chooses the linear resolution that holds a frame time.

    The cost of a frame is taken as proportional to its pixels: cost = c * scale ** 2.

    Args:
        frame_ms: frame time to hold [ms].
    """

    def __init__(self, frame_ms: float) -> None:
        self.frame_ms = frame_ms
        self._full: deque[float] = deque(maxlen=REMEMBERED)
        self._scale = 1.0

    @property
    def scale(self) -> float:
        """Linear scale of the next moving frame, in [0.375, 1], a multiple of 1/16."""
        return self._scale

    @property
    def expected_ms(self) -> float | None:
        """What a picture at full resolution is expected to cost [ms]; None before the first."""
        return statistics.median_low(self._full) if self._full else None

    def observe(self, cost_ms: float, scale: float) -> None:
        """Learn from a frame.

        Args:
            cost_ms: what rendering and encoding it took [ms].
            scale: the linear scale it was drawn at.
        """
        self._full.append(max(cost_ms, 1e-3) / (scale * scale))
        full = statistics.median_low(self._full)
        wanted = self._holding(full)
        if wanted < self._scale:
            self._scale = wanted
        else:
            self._scale = max(self._scale, self._holding(full / HEADROOM))

    def _holding(self, full: float) -> float:
        """The scale that holds the frame time, or at least `SLOWEST_MS`, where a full picture takes `full` ms."""
        scale = math.sqrt(self.frame_ms / full)
        slowest = math.sqrt(max(self.frame_ms, SLOWEST_MS) / full)
        return _step(max(scale, min(slowest, LOWEST_SCALE)))

    def forget(self) -> None:
        """Drop what was learnt: the canvas has another size."""
        self._full.clear()


class Movers:
    """Which views move: those that only refine their picture let them go first."""

    def __init__(self) -> None:
        self._moved: WeakKeyDictionary[Any, float] = WeakKeyDictionary()

    def note(self, view: Any, now: float) -> None:
        """A view drew a picture of a movement at time `now` [s]."""
        self._moved[view] = now

    def others(self, view: Any, now: float) -> bool:
        """Whether any other view moved just before `now` [s]."""
        return any(now - at < MOVING_S for other, at in self._moved.items() if other is not view)


def scaled(width: int, height: int, scale: float) -> tuple[int, int]:
    """Size of a picture drawn at a linear scale for a canvas of this size [px]."""
    return max(1, round(width * scale)), max(1, round(height * scale))


def _step(scale: float) -> float:
    return min(1.0, max(COARSEST_SCALE, math.floor(scale * STEPS) / STEPS))


class Allowance:
    """A token bucket: `rate` messages a second, and as many at once.

    Args:
        rate: messages a second.
        now: the current time [s].
    """

    def __init__(self, rate: float, now: float) -> None:
        self.rate = rate
        self._left = rate
        self._at = now
        self._told = -math.inf

    def take(self, now: float) -> bool:
        """Whether one more message is allowed at time `now` [s]."""
        self._left = min(self.rate, self._left + (now - self._at) * self.rate)
        self._at = now
        if self._left < 1:
            return False
        self._left -= 1
        return True

    def tell(self, now: float) -> bool:
        """Whether to say so: at most once a second, or the answer to a flood would be a flood."""
        if now - self._told < 1:
            return False
        self._told = now
        return True
