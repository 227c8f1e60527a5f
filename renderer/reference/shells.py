"""The shells' reference picture: every ray through every tetrahedron, float64, on the CPU, with its standard error.

Shares no code with the renderer: it receives the world as plain arrays and finds planes, maps and orders again by
itself. Between two borders of voxels, exactly: matter that is constant there is integrated in closed form; interpolated
matter by two parts of two Gauss-Legendre nodes, the source linear in the optical depth. Where solids overlap, their
extinctions and emissions add. The way to the sun crosses every shell alike, two nodes a voxel, and ends behind opaque
faces; how much of it is left is sampled in strata along the ray of the eye, which is the only noise of the picture and
what its standard error speaks of. The sky's light is not shadowed, by the definition of the light.

Where matter scatters within itself, the picture is of paths of light instead (`shells_paths`): all orders, faces among
them, the sun through all shells and the sky from where it is seen; nothing of it is approximated, all of it is noisy.
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
from renderer.reference.shells_paths import path_rows
from renderer.reference.shells_rays import MOST, rows
from renderer.reference.shells_world import Floats, Scene, ShellsWorld, prepare

Rays = Callable[[tuple[float, float]], tuple[Floats, Floats]]
Progress = Callable[[float, str], None]

PATHS, POSITIONS = 2_500_000, 16
"""Paths of a picture of scattered light, and its positions: a minute or two on two cores."""

CHUNK = 4
"""Rows between two looks at the caller's wish to stop."""


@dataclass(frozen=True)
class Options:
    """How finely light is sampled.

    Attributes:
        sun_rays: strata of sunlight on white that faces it, one ray each; darker matter has fewer.
        paths: of each ray where light is scattered; 0 for `PATHS` in a picture of 16 positions, whatever its size.
        orders: of scattering that a path is followed for; 0 for all.
        seed: of all that is random.
        threads: that trace; 0 takes every core.
    """

    sun_rays: int = 512
    paths: int = 0
    orders: int = 0
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
    if options.sun_rays < 1 or options.paths < 0 or options.paths == 1 or options.orders < 0:
        raise InputError("options", "the sun needs a ray, and an error two paths")
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
            task = _task(world, scene, options, (origins, directions, behind), number, sums)
            _position(pool, task, origins.shape[0], (number, len(places)), report)
    assert sums is not None
    return Reference(sums[0] / len(places), np.sqrt(sums[1]) / len(places), time.perf_counter() - begun)


def _task(
    world: ShellsWorld,
    scene: Scene,
    options: Options,
    rays: tuple[Floats, Floats, Floats],
    number: int,
    sums: tuple[Floats, Floats],
) -> Callable[[int, int], bool]:
    """What adds some rows of one position to the sums; tells whether there was room for all that meets."""
    if world.light == "scattering":
        scattering = np.array([world.asymmetry, options.orders or np.inf, world.sky_below])
        paths = options.paths or max(8, round(PATHS / POSITIONS / rays[0][..., 0].size))
        return lambda begin, end: path_rows(scene, *rays, begin, end, scattering, paths, options.seed, number, *sums)
    quantum = max(float(scene.lights[1].mean()) / math.pi, 1e-300) / options.sun_rays
    return lambda begin, end: rows(scene, *rays, begin, end, quantum, options.seed, number, *sums)


def _position(
    pool: ThreadPoolExecutor, task: Callable[[int, int], bool], height: int, which: tuple[int, int], report: Progress
) -> None:
    """Add one position of the whole picture, a few rows at a time on every thread."""
    number, count = which
    waiting = [pool.submit(task, first, min(first + CHUNK, height)) for first in range(0, height, CHUNK)]
    try:
        for done, chunk in enumerate(waiting, start=1):
            if not chunk.result():
                raise LimitError("tets", f"more than {MOST} of them share a place", "a shell that overlaps itself less")
            report((number + done / len(waiting)) / count, "tracing the reference")
    finally:
        for chunk in waiting:
            chunk.cancel()
