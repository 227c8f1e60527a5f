"""The forest's reference picture: float64, on the CPU, with its own standard error.

Shares no code with the renderer: it receives the world as plain arrays and looks everything up again by itself. View
rays are marched at 512 steps for a crossing of the layer; shadow rays at three steps a voxel, which on the default
scene moves the mean by less than 1e-4 against steps a quarter as long. The positions of rays within the pixels are the
caller's, so that a technique's converged picture can use the same ones and the difference speaks of the method alone.
"""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from renderer.core.errors import InputError
from renderer.reference.forest_light import GOURAUD, LAMBERT, LEAF, NOMINAL_ALBEDO, rows
from renderer.reference.forest_world import Floats, ForestWorld, Scene, prepare

Rays = Callable[[tuple[float, float]], tuple[Floats, Floats]]
Progress = Callable[[float, str], None]

STEPS_PER_CROSSING = 512
"""Steps of a march straight through the layer: what the project calls brute force."""

LONGEST_STEP = 0.3
"""Longest step of a march, in voxels: below a third of the trilinear filter's width."""

LIGHTS = {"leaf": LEAF, "lambert": LAMBERT, "gouraud": GOURAUD}
"""The light switch by its option."""

CHUNK = 8
"""Rows between two looks at the clock and the caller's wish to stop."""


@dataclass(frozen=True)
class Options:
    """What is lit how, and how finely it is marched.

    Attributes:
        terrain: the ground shades forest and ground.
        forest_on_ground: trees shade the ground.
        tree_on_tree: trees shade other trees.
        within_tree: a tree shades itself.
        light: `leaf`, what thin leaves lying as the voxels' normals do make of the sun; or techniques' own `lambert` by
            those normals, `gouraud` by the terrain's.
        sky: `hemisphere`, rays to the sky's own radiance by direction; or `share`, its whole light times the share of
            it that the pattern holds at the place.
        shadow_rays: strata of sunlight on a leaf's full brightness, one shadow ray each; 0 gives every step its own.
        sky_rays: strata of an open sky's light on a leaf's full brightness, one ray each.
        steps_per_crossing: steps of a vertical view march through the layer.
        longest_step: of a slanted one, voxels.
        shadow_step: of the march to the sun, voxels.
        seed: of the jitter within the strata.
        threads: that march; 0 takes every core.
    """

    terrain: bool = True
    forest_on_ground: bool = True
    tree_on_tree: bool = True
    within_tree: bool = True
    light: Literal["leaf", "lambert", "gouraud"] = "leaf"
    sky: Literal["hemisphere", "share"] = "share"
    shadow_rays: int = 16
    sky_rays: int = 16
    steps_per_crossing: int = STEPS_PER_CROSSING
    longest_step: float = LONGEST_STEP
    shadow_step: float = LONGEST_STEP
    seed: int = 1
    threads: int = 0


@dataclass(frozen=True)
class Reference:
    """A reference picture.

    Attributes:
        radiance: (H, W, 4) float64 linear, premultiplied, W m-2 sr-1, row 0 at the top.
        standard_error: (H, W) of the mean over the channels, W m-2 sr-1, at the given positions: it tells how far
            another seed would fall, not what other positions in the pixel would show. Neighbouring strata stand in for
            repeated draws, which overstates it where the shadow changes along the ray.
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
    world: ForestWorld,
    rays: Rays,
    positions: NDArray[np.floating],
    options: Options | None = None,
    progress: Progress | None = None,
) -> Reference:
    """March the reference picture.

    Args:
        world: the forest.
        rays: origins and unit directions (H, W, 3) for one position within the pixels.
        positions: (S, 2) across and down from each pixel's top left corner, in pixels.
        options: shadows, light and fineness.
        progress: told the share done after every few rows; raises `Cancelled` to stop.

    Raises:
        InputError: no positions, or options out of range.
        Cancelled: by `progress`.
    """
    options = options or Options()
    offsets = np.asarray(positions, np.float64)
    if offsets.ndim != 2 or offsets.shape[1] != 2 or not len(offsets):
        raise InputError("positions", f"has shape {offsets.shape}", "(S, 2), S at least 1")
    if options.steps_per_crossing < 1 or min(options.longest_step, options.shadow_step) <= 0 or options.shadow_rays < 0:
        raise InputError("options", "steps and rays cannot be negative, nor a step without length")
    if options.sky_rays < 1:
        raise InputError("options", "the sky needs at least one ray")
    begun = time.perf_counter()
    scene = prepare(world)
    total: Floats | None = None
    variance: Floats | None = None
    report = progress or (lambda share, words: None)
    with ThreadPoolExecutor(options.threads or os.cpu_count() or 1) as pool:
        for number, (across, down) in enumerate(offsets):
            origins, directions = (
                np.require(part, np.float64, ["C", "W"]) for part in rays((float(across), float(down)))
            )
            if total is None or variance is None:
                total, variance = np.zeros((*origins.shape[:2], 4)), np.zeros(origins.shape[:2])
            behind = np.zeros_like(directions)
            if world.background is not None:
                behind = np.ascontiguousarray(world.background(directions.reshape(-1, 3)), np.float64).reshape(
                    directions.shape
                )
            _sample(pool, scene, options, (origins, directions, behind), number, len(offsets), total, variance, report)
    assert total is not None
    assert variance is not None
    count = len(offsets)
    return Reference(total / count, np.sqrt(variance) / count, time.perf_counter() - begun)


def _sample(
    pool: ThreadPoolExecutor,
    scene: Scene,
    options: Options,
    rays: tuple[Floats, Floats, Floats],
    number: int,
    count: int,
    total: Floats,
    variance: Floats,
    report: Progress,
) -> None:
    """Add one sub-pixel sample of the whole picture, a few rows at a time on every thread."""
    switches = np.array([options.terrain, options.forest_on_ground, options.tree_on_tree, options.within_tree,
                         LIGHTS[options.light], options.sky == "hemisphere"])
    steps = (
        scene.height / options.steps_per_crossing,
        options.longest_step * scene.voxel,
        options.shadow_step * scene.voxel,
    )
    bright = NOMINAL_ALBEDO / math.pi
    quanta = (
        float(scene.e_sun.mean()) * bright / options.shadow_rays if options.shadow_rays else 0.0,
        max(float(scene.e_sky.mean()), 1e-300) * bright / options.sky_rays,
    )
    height = total.shape[0]
    waiting = [
        pool.submit(rows, scene, switches, *rays, first, min(first + CHUNK, height), steps, quanta, options.seed,
                    number, total, variance)
        for first in range(0, height, CHUNK)
    ]
    try:
        for done, chunk in enumerate(waiting, start=1):
            chunk.result()
            report((number + done / len(waiting)) / count, "marching the reference")
    finally:
        for chunk in waiting:
            chunk.cancel()
