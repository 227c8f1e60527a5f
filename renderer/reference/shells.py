"""The shells' reference picture: every ray through every tetrahedron, float64, on the CPU, with its standard error.

Shares no code with the renderer: it receives the world as plain arrays and finds planes, maps and orders again by
itself. Between two borders of voxels, exactly: matter that is constant there is integrated in closed form; interpolated
matter by two parts of two Gauss-Legendre nodes, the source linear in the optical depth. Where solids overlap, their
extinctions and emissions add. The way to the sun crosses every shell alike, two nodes a voxel, and ends behind opaque
faces; how much of it is left is sampled in strata along the ray of the eye, which is the only noise of the picture and
what its standard error speaks of. The sky's light is not shadowed, by the definition of the light.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from renderer.core.errors import InputError, LimitError
from renderer.reference.shells_rays import MOST, rows
from renderer.reference.shells_world import Floats, Scene, ShellsWorld, prepare

Rays = Callable[[tuple[float, float]], tuple[Floats, Floats]]
Progress = Callable[[float, str], None]

CHUNK = 4
"""Rows between two looks at the caller's wish to stop."""


@dataclass(frozen=True)
class Options:
    """How finely the sun's light is sampled.

    Attributes:
        sun_rays: strata of sunlight on white that faces it, one ray each; darker matter has fewer.
        seed: of the places within the strata.
        threads: that trace; 0 takes every core.
    """

    sun_rays: int = 128
    seed: int = 1
    threads: int = 0


@dataclass(frozen=True)
class Reference:
    """A reference picture.

    Attributes:
        radiance: (H, W, 4) float64 linear, premultiplied, W m-2 sr-1, row 0 at the top.
        standard_error: (H, W) of the mean over the channels, W m-2 sr-1, at the given positions: how far another seed
            would fall. Neighbouring strata stand in for repeated draws, which overstates it where light changes along
            the ray.
        seconds: wall-clock time.
    """

    radiance: Floats
    standard_error: Floats
    seconds: float

    @property
    def relative_error(self) -> float:
        """Root mean square of the standard error over the pixels, divided by the mean radiance."""
        mean = float(self.radiance[..., :3].mean())
        return float(np.sqrt(np.mean(self.standard_error**2))) / mean if mean > 0 else 0.0


def render(
    world: ShellsWorld,
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
        LimitError: more than `MOST` solids share a place.
        Cancelled: by `progress`.
    """
    options = options or Options()
    places = np.asarray(positions, np.float64)
    if places.ndim != 2 or places.shape[1] != 2 or not len(places):
        raise InputError("positions", f"has shape {places.shape}", "(S, 2), S at least 1")
    if options.sun_rays < 1:
        raise InputError("options", "the sun needs at least one ray")
    begun = time.perf_counter()
    scene = prepare(world)
    report = progress or (lambda share, words: None)
    sums: tuple[Floats, Floats] | None = None
    with ThreadPoolExecutor(options.threads or os.cpu_count() or 1) as pool:
        for number, (across, down) in enumerate(places):
            # copied: a frozen array would be one more type to compile for
            origins, directions = (np.array(part, np.float64, order="C") for part in rays((float(across), float(down))))
            behind = np.zeros_like(directions)
            if world.background is not None:
                behind[:] = np.reshape(world.background(directions.reshape(-1, 3)), directions.shape)
            if sums is None:
                sums = np.zeros((*origins.shape[:2], 4)), np.zeros(origins.shape[:2])
            _position(pool, scene, options, (origins, directions, behind), (number, len(places)), sums, report)
    assert sums is not None
    return Reference(sums[0] / len(places), np.sqrt(sums[1]) / len(places), time.perf_counter() - begun)


def _position(
    pool: ThreadPoolExecutor,
    scene: Scene,
    options: Options,
    rays: tuple[Floats, Floats, Floats],
    which: tuple[int, int],
    sums: tuple[Floats, Floats],
    report: Progress,
) -> None:
    """Add one position of the whole picture, a few rows at a time on every thread."""
    number, count = which
    quantum = max(float(scene.lights[1].mean()) / math.pi, 1e-300) / options.sun_rays
    height = sums[0].shape[0]
    waiting = [
        pool.submit(rows, scene, *rays, first, min(first + CHUNK, height), quantum, options.seed, number, *sums)
        for first in range(0, height, CHUNK)
    ]
    try:
        for done, chunk in enumerate(waiting, start=1):
            if not chunk.result():
                raise LimitError("tets", f"more than {MOST} of them share a place", "a shell that overlaps itself less")
            report((number + done / len(waiting)) / count, "tracing the reference")
    finally:
        for chunk in waiting:
            chunk.cancel()
