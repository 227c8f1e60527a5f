"""How a whole land is lit over a stretch of time: hours of direct sun, irradiation by beam and by sky at every node.

After Dozier and Frew 1990: horizons by azimuth, the sky's share by their integral. The horizon along the azimuth of
each bin of suns (`renderer.world.sun_course`) says which of them a node sees.

Assumed: flat Earth, level land beyond the grid, an evenly bright sky, no light from the ground, trees that let nothing
through. It claims nothing about the ground under trees.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from renderer.world import sunlight_kernels as kernels
from renderer.world import terrain as land
from renderer.world.sun_course import Course

Floats = NDArray[np.float64]
Progress = Callable[[float, str], None]

SKY_DIRECTIONS = 16
"""Azimuths whose horizon bounds the visible sky: they err by 0.4 % of its light at most, on a rough fractal land."""

CHUNK = 4096
"""Nodes between two reports of progress: some tenths of a second."""

COVERED = 0.5
"""Height in metres from which a canopy covers the ground under it."""


def along(azimuths: Floats, cell_size: tuple[float, float]) -> Floats:
    """Rows and columns a metre along azimuths, (A, 2); exactly 0 along the grid's lines."""
    down, right = -np.cos(azimuths), np.sin(azimuths)
    down[np.abs(down) < 1e-12] = 0.0
    right[np.abs(right) < 1e-12] = 0.0
    return np.stack([down / cell_size[1], right / cell_size[0]], axis=1)


@dataclass(frozen=True)
class Light:
    """The land as a sun study sees it, made once and asked for any nodes.

    Args:
        ground: (rows, columns) m above the sea.
        surface: (rows, columns) m: what hides the sun, the ground with what stands on it.
        cell_size: (dx, dy) m.
        suns: of the range.
        altitudes: those of the suns' light, m.
        receiver: as `SunlightPeriod.receiver`.
    """

    ground: NDArray[np.float32]
    surface: NDArray[np.float32]
    cell_size: tuple[float, float]
    suns: Course
    altitudes: tuple[float, float]
    receiver: str

    def at(self, nodes: NDArray[np.int64], progress: Progress | None = None) -> NDArray[np.float32]:
        """Light of some nodes.

        Args:
            nodes: (N, 2) rows and columns.
            progress: told the share done; may raise `Cancelled`.

        Returns:
            (N, 4): hours of direct sun [h], irradiation by beam and by sky [kWh m-2], share of the sky; NaN on the
            ground under trees.
        """
        if self.receiver == "ground":
            lit = (self.surface - self.ground)[nodes[:, 0], nodes[:, 1]] <= COVERED
        else:
            lit = np.ones(len(nodes), np.bool_)
        result = np.full((len(nodes), kernels.CHANNELS), np.nan, np.float32)
        result[lit] = self._of(np.ascontiguousarray(nodes[lit]), progress or _silent)
        return result

    def _of(self, nodes: NDArray[np.int64], progress: Progress) -> NDArray[np.float32]:
        surface = self.ground if self.receiver == "bare_ground" else self.surface
        low, high = self.altitudes
        rows, columns = nodes[:, 0], nodes[:, 1]
        share = np.clip((self.ground[rows, columns] - low) / max(high - low, 1e-6), 0.0, 1.0).astype(np.float64)
        normals = land.normals(self.ground, self.cell_size)[rows, columns]
        # one type, whatever the land came as, or all is compiled again
        surface = np.require(surface, np.float32, ["C", "W"])
        levels = kernels.pyramid(surface)
        steps = along(self.suns.azimuths, self.cell_size)
        around = np.arange(SKY_DIRECTIONS, dtype=np.float64) * (2 * np.pi / SKY_DIRECTIONS)
        sky = np.concatenate([along(around, self.cell_size), np.sin(around)[:, None], np.cos(around)[:, None]], axis=1)
        result = np.zeros((len(nodes), kernels.CHANNELS), np.float32)

        def part(first: int) -> None:
            several = slice(first, first + CHUNK)
            kernels.light(surface, levels, nodes[several], normals[several], share[several], steps,
                          self.suns.firsts, self.suns.tangents, self.suns.sums, sky, self.suns.diffuse,
                          result[several])  # fmt: skip

        _in_threads(part, range(0, len(nodes), CHUNK), progress)
        return result


def _in_threads(part: Callable[[int], None], pieces: range, progress: Progress) -> None:
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        try:
            for done, _ in enumerate(pool.map(part, pieces), 1):
                progress(done / len(pieces), "following the sun")
        except BaseException:
            pool.shutdown(wait=True, cancel_futures=True)
            raise


def _silent(share: float, words: str) -> None:
    """Progress that nobody listens to."""
