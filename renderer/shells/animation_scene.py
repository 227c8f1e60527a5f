"""The scene's surface and shell at a moment, as arrays like those of their bakes."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass

import numpy as np

from renderer.core.technique import Arrays, BakedArrays
from renderer.shells.animation import AnyMotion, MovingShell, Still
from renderer.shells.extrusion import Extrusion


@dataclass(frozen=True)
class Moment:
    """Surface and shell at a moment.

    Args:
        key: equal keys mean equal arrays.
        surface, shell: arrays as the bakes give them.
        changed: (N,) tetrahedra that differ from those of the moment before, or None where all may.
        before: key of the moment before.
    """

    key: Hashable
    surface: Arrays
    shell: Arrays
    changed: np.ndarray | None
    before: Hashable = None


def moment(surface: Arrays, shell: Arrays, extrusion: Extrusion, motion: AnyMotion, time: float) -> Moment:
    """Surface and shell at a time [s], computed without a memory of other times: the same to the last bit as `Animator`
    gives, whatever it drew before, but for what a motion's key frames err by.

    Args:
        surface, shell: arrays of the bakes. extrusion, motion: the document's.
    """
    if isinstance(motion, Still):
        return Moment(None, surface, shell, None)
    moving = MovingShell(surface, shell, extrusion)
    moving.move(motion, time)
    return Moment((motion, time), *moving.arrays(surface, shell), None)


class Animator:
    """Follows one scene from moment to moment, computing what moved alone."""

    def __init__(self) -> None:
        self._key: Hashable = None
        self._moving: MovingShell | None = None
        self._last: Moment | None = None

    def at(
        self, surface: BakedArrays, shell: BakedArrays, extrusion: Extrusion, motion: AnyMotion, time: float
    ) -> Moment:
        """Surface and shell at a time [s]; their bakes, where nothing moves."""
        if isinstance(motion, Still):
            return Moment(shell.key, surface.arrays, shell.arrays, None)
        kept = shell.key, motion.frames > 0
        if self._moving is None or self._key != kept:
            self._key, self._last = kept, None
            self._moving = MovingShell(surface.arrays, shell.arrays, extrusion)
        key = (shell.key, motion, time)
        if self._last is not None and self._last.key == key:
            return self._last
        before, changed = self._last, None
        if motion.frames:
            self._moving.interpolate(motion, time)
        else:
            changed = self._moving.move(motion, time)
        arrays = self._moving.arrays(surface.arrays, shell.arrays)
        self._last = Moment(key, *arrays, changed if before else None, before.key if before else None)
        return self._last
