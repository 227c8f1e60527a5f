"""Computes bakes and keeps their results.

A bake is a pure function of its arguments and inputs, so its result is kept in the cache under a key made of these,
and whoever asks for it while somebody else computes it waits for that result instead of computing it again.
`renderer.core.work` does the same in worker processes.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator, Mapping

import numpy as np

from renderer.core.cache import Cache, key_of
from renderer.core.channel import Progress
from renderer.core.errors import UmbrageError
from renderer.core.technique import Arrays, Bake

Report = Callable[[Progress], None]
"""Receives progress; may raise `Cancelled` to end the work."""


def bake_key(bake: Bake) -> str:
    """The cache key of a bake's result: its function, version, arguments, and the keys of its inputs.

    The role `name` is no part of it: the same computation in another role is the same result.
    """
    function = f"{bake.function.__module__}.{bake.function.__qualname__}"
    inputs = {source.name: bake_key(source) for source in bake.inputs}
    return key_of("bake", function, bake.version, bake.arguments, inputs)


def missing(bakes: Iterable[Bake], cache: Cache) -> list[Bake]:
    """What must be computed to have all of `bakes`, inputs first, each result once.

    An input is not missing where all that needs it is already cached.
    """
    found: dict[str, Bake] = {}

    def visit(bake: Bake) -> None:
        key = bake_key(bake)
        if key in found or key in cache:
            return
        for source in bake.inputs:
            visit(source)
        found[key] = bake

    for bake in bakes:
        visit(bake)
    return list(found.values())


def expected_seconds(bakes: Iterable[Bake], cache: Cache) -> float:
    """Announced time to compute what is missing of `bakes` on two cores, s."""
    return sum(bake.seconds for bake in missing(bakes, cache))


class _Clock:
    """Turns the progress of one bake after another into that of the whole."""

    def __init__(self, bakes: Iterable[Bake], report: Report | None) -> None:
        self._seconds = {bake_key(bake): max(bake.seconds, 1e-3) for bake in bakes}
        self._total = sum(self._seconds.values()) or 1e-3
        self._done: set[str] = set()
        self._best = 0.0
        self._started = time.monotonic()
        self._report = report

    def finish(self, bake: Bake) -> None:
        """Count a bake as done."""
        self._done.add(bake_key(bake))

    def tell(self, bake: Bake, fraction: float, words: str) -> None:
        """Report that `fraction` of a bake is done."""
        if self._report is None:
            return
        key = bake_key(bake)
        within = 0.0 if key in self._done else min(max(fraction, 0.0), 1.0) * self._seconds.get(key, 0.0)
        whole = (sum(self._seconds.get(key, 0.0) for key in self._done) + within) / self._total
        self._best = max(self._best, min(whole, 1.0))
        elapsed = time.monotonic() - self._started
        # Below a tenth the announced time is the better guess; above it, the pace so far.
        left = elapsed / self._best * (1 - self._best) if self._best > 0.1 else self._total * (1 - self._best)
        self._report(Progress(bake.name, self._best, words, left))


def bake_now(bake: Bake, cache: Cache, progress: Report | None = None) -> dict[str, np.ndarray]:
    """Compute a bake in this process, or take it from the cache.

    Args:
        bake: what to compute; its inputs come first, where they are needed.
        cache: where results are looked up and kept.
        progress: told how far the whole is; may raise `Cancelled`.

    Returns:
        The arrays of that bake.

    Raises:
        UmbrageError: the bake failed, with its name and the reason in words.
        Cancelled: raised by `progress`.
    """
    return _bake(bake, cache, _Clock(missing([bake], cache), progress))


def _bake(bake: Bake, cache: Cache, clock: _Clock) -> dict[str, np.ndarray]:
    key = bake_key(bake)
    arrays = cache.get(key)
    if arrays is None:
        # Before this bake's lock is taken: who holds a lock waits for nothing, so no two can wait for each other.
        inputs = {source.name: _bake(source, cache, clock) for source in bake.inputs}
        with cache.lock(key, waiting=lambda: clock.tell(bake, 0.0, "waiting for whoever computes the same")):
            arrays = cache.get(key)
            if arrays is None:
                arrays = _computed(bake, inputs, clock)
                cache.put(key, arrays)
    clock.finish(bake)
    return arrays


def _computed(bake: Bake, inputs: Mapping[str, Arrays], clock: _Clock) -> dict[str, np.ndarray]:
    clock.tell(bake, 0.0, "starting")
    try:
        arrays = bake.function(bake.arguments, dict(inputs), lambda fraction, words: clock.tell(bake, fraction, words))
    except UmbrageError:
        raise
    except Exception as failure:
        # Named and in words: not every exception survives the way back from a worker process.
        raise UmbrageError(f"{bake.name} could not be computed: {type(failure).__name__}: {failure}") from failure
    return {name: np.asarray(array) for name, array in arrays.items()}


def gather(bakes: Iterable[Bake], cache: Cache, progress: Report | None = None) -> Iterator[tuple[str, Arrays]]:
    """Name and arrays of each of `bakes` in turn, computed in this process where they are not cached."""
    bakes = list(bakes)
    clock = _Clock(missing(bakes, cache), progress)
    for bake in bakes:
        yield bake.name, _bake(bake, cache, clock)
