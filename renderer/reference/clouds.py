"""The clouds' reference picture: paths of light traced through planet, land, air and clouds, float64, on the CPU.

Shares no code with the renderer: it receives the world as plain arrays and looks everything up again by itself. Nothing
is taken for a plane layer, and no order of scattering is left out: droplets scatter by Mie's phase function in each
band, without absorption; the layer stands on its base and is as thick as its map says at each place; the ground is
Lambert's; the air's molecules, haze and ozone scatter and absorb along every way longer than 200 m.

It is unbiased but for three things, each far below its standard error: the air inside clouds, which scatters a
thousandth of what they do, is left out on ways of less than 200 m; the layer's upper side is found by steps of half a
texel of its map, between which it counts as straight; a way bent by the droplets' forward peak on its way to the sun
has the air of its two ends. The disc of the sun itself is not in the picture.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from renderer.core.errors import InputError
from renderer.reference.clouds_paths import rows
from renderer.reference.clouds_world import CloudsWorld, Floats, Scene, prepare

Rays = Callable[[tuple[float, float]], tuple[Floats, Floats]]
Progress = Callable[[float, str], None]

PATHS, POSITIONS = 2_500_000, 16
"""Paths of a picture, and its positions: a minute or two on two cores, and a standard error of 3 to 8 % at 48 pixels a
side."""

CHUNK = 4
"""Rows between two looks at the caller's wish to stop."""


@dataclass(frozen=True)
class Options:
    """How finely the paths are sampled.

    Attributes:
        paths: from each of a pixel's positions, spread over a square of a quarter of its side around it, so that what
            is finer than the positions lie apart is averaged and not picked; 0 for `PATHS` in a picture of 16
            positions, whatever its size.
        seed: of every random number.
        threads: that trace; 0 takes every core.
    """

    paths: int = 0
    seed: int = 1
    threads: int = 0


@dataclass(frozen=True)
class Reference:
    """A reference picture.

    Attributes:
        radiance: (H, W, 4) float64 linear, premultiplied, W m-2 sr-1, row 0 at the top.
        standard_error: (H, W) of the mean over the channels, W m-2 sr-1: of independent paths, which overstates it,
            for they start from a low-discrepancy sequence.
        regions: (H, W, 3) how much of each pixel meets space, cloud and ground first.
        seconds: wall-clock time.
    """

    radiance: Floats
    standard_error: Floats
    regions: Floats
    seconds: float

    @property
    def relative_error(self) -> float:
        """Root mean square of the standard error over the pixels, divided by the mean radiance."""
        mean = float(self.radiance[..., :3].mean())
        return float(np.sqrt(np.mean(self.standard_error**2))) / mean if mean > 0 else 0.0


def render(
    world: CloudsWorld,
    rays: Rays,
    positions: NDArray[np.floating],
    options: Options | None = None,
    progress: Progress | None = None,
) -> Reference:
    """Trace the reference picture.

    Args:
        world: what stands where.
        rays: origins and unit directions (H, W, 3) for one position within the pixels.
        positions: (S, 2) across and down from each pixel's top left corner, in pixels.
        options: fineness.
        progress: told the share done after every few rows; raises `Cancelled` to stop.

    Raises:
        InputError: no positions, options out of range, or a world that does not fit.
        Cancelled: by `progress`.
    """
    options = options or Options()
    places = np.asarray(positions, np.float64)
    if places.ndim != 2 or places.shape[1] != 2 or not len(places):
        raise InputError("positions", f"has shape {places.shape}", "(S, 2), S at least 1")
    if options.paths < 0 or options.paths == 1:
        raise InputError("options", "fewer than two paths have no standard error")
    begun = time.perf_counter()
    scene = prepare(world)
    report = progress or (lambda share, words: None)
    sums: tuple[Floats, Floats, Floats] | None = None
    with ThreadPoolExecutor(options.threads or os.cpu_count() or 1) as pool:
        for number, (across, down) in enumerate(places):
            spread = _spread(rays, float(across), float(down))
            height, width = spread.shape[2:4]
            if sums is None:
                sums = np.zeros((height, width, 4)), np.zeros((height, width)), np.zeros((height, width, 3))
            paths = options.paths or max(8, round(PATHS / POSITIONS / (height * width)))
            _position(pool, scene, (paths, options.seed), spread, (number, len(places)), sums, report)
    assert sums is not None
    count = len(places)
    return Reference(sums[0] / count, np.sqrt(sums[1]) / count, sums[2] / count, time.perf_counter() - begun)


def _spread(rays: Rays, across: float, down: float) -> Floats:
    """Beginnings and directions of a position's rays, and how they change by a pixel to the right and down,
    (2, 3, H, W, 3)."""
    here, beside, below = rays((across, down)), rays((across + 1.0, down)), rays((across, down + 1.0))
    return np.array([[here[k], beside[k] - here[k], below[k] - here[k]] for k in range(2)], np.float64)


def _position(
    pool: ThreadPoolExecutor,
    scene: Scene,
    sampling: tuple[int, int],
    spread: Floats,
    which: tuple[int, int],
    sums: tuple[Floats, Floats, Floats],
    report: Progress,
) -> None:
    """Add one position of the whole picture, a few rows at a time on every thread."""
    number, count = which
    height = sums[0].shape[0]
    waiting = [
        pool.submit(rows, scene, spread, first, min(first + CHUNK, height), *sampling, number, *sums)
        for first in range(0, height, CHUNK)
    ]
    try:
        for done, chunk in enumerate(waiting, start=1):
            chunk.result()
            report((number + done / len(waiting)) / count, "tracing the reference")
    finally:
        for chunk in waiting:
            chunk.cancel()
