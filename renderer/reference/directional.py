"""The directional textures' reference picture: the mesh itself, ray by ray, with its standard error.

Shares no code with the renderer, and has neither its points nor its directions: rays meet the triangles (Embree),
normals are interpolated between corners, BRDFs looked up in float64, and each hit looks for the sun, the lamp and the
mirror's light by a ray of its own. Only how open a place is to the sky is sampled, by strata of equal cosine, which is
the picture's only noise beside its positions, and what its standard error speaks of.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from renderer.core.errors import InputError
from renderer.reference.directional_light import Shading
from renderer.reference.directional_mesh import Subject
from renderer.reference.directional_world import DirectionalWorld, Floats

Rays = Callable[[tuple[float, float]], tuple[Floats, Floats]]
Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Options:
    """How finely light is sampled.

    Attributes:
        strata: square root of the rays from each hit to the sky; even.
        seed: of their places.
    """

    strata: int = 6
    seed: int = 1


@dataclass(frozen=True)
class Reference:
    """A reference picture.

    Attributes:
        radiance: (H, W, 4) float64 linear, premultiplied, W m-2 sr-1, row 0 at the top; alpha is the share of the
            positions that meet the subject, 1 throughout over a background.
        standard_error: (H, W) of the mean over the channels, W m-2 sr-1, at the given positions: how far another seed
            would fall.
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
    world: DirectionalWorld,
    rays: Rays,
    positions: NDArray[np.floating],
    options: Options | None = None,
    progress: Progress | None = None,
) -> Reference:
    """Cast the reference picture.

    Args:
        world: what stands there.
        rays: origins and unit directions (H, W, 3) for one position within the pixels.
        positions: (S, 2) across and down from each pixel's top left corner, in pixels.
        options: fineness.
        progress: told the share done after every position; raises `Cancelled` to stop.

    Raises:
        InputError: no positions, or strata out of range.
        Cancelled: by `progress`.
    """
    options = options or Options()
    places = np.asarray(positions, np.float64)
    if places.ndim != 2 or places.shape[1] != 2 or not len(places):
        raise InputError("positions", f"has shape {places.shape}", "(S, 2), S at least 1")
    if options.strata < 2 or options.strata % 2:
        raise InputError("strata", f"are {options.strata}", "an even number, for their differences tell the error")
    begun = time.perf_counter()
    subject = Subject(world)
    shading, rng = Shading(world, subject, options.strata), np.random.default_rng(options.seed)
    sums: tuple[Floats, Floats] | None = None
    for number, (across, down) in enumerate(places):
        origins, directions = (np.asarray(part, np.float64) for part in rays((float(across), float(down))))
        shape = origins.shape[:2]
        flat = np.ascontiguousarray(directions.reshape(-1, 3))
        hit, hits = subject.met(np.ascontiguousarray(origins.reshape(-1, 3)), flat)
        found, variance = np.zeros((len(flat), 4)), np.zeros(len(flat))
        found[hit, :3], variance[hit] = shading.radiance(hits, rng)
        found[hit, 3] = 1
        if world.background is not None:
            found[~hit, :3], found[~hit, 3] = np.reshape(world.background(flat[~hit]), (-1, 3)), 1
        if sums is None:
            sums = np.zeros((*shape, 4)), np.zeros(shape)
        sums[0][:] += found.reshape(*shape, 4)
        sums[1][:] += variance.reshape(shape)
        if progress is not None:
            progress((number + 1) / len(places), "casting the reference")
    assert sums is not None
    return Reference(sums[0] / len(places), np.sqrt(sums[1]) / len(places), time.perf_counter() - begun)
