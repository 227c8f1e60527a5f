"""Ray marching of the canopy layer."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.forest.technique import ForestTechnique

FIRST_STOP = 0.1
"""Transmittance at which a ray of the first sample ends, where its steps are longer than the others'."""


class RayMarch(ForestTechnique):
    """Samples the canopy along each ray, front to back; skips what is empty, stops when nothing shows through.

    In a picture's first sample a ray stands for four pixels and takes longer steps: smoothed, that is nearer to the
    converged picture than a ray a pixel as it is.
    """

    title: ClassVar[str] = "Ray marching"
    caption: ClassVar[str] = "Walks each ray through the canopy: no slices to see at any angle."
    paper: ClassVar[str] = "Levoy 1990; Decaudin & Neyret 2009"

    kind: Literal["ray_march"] = "ray_march"
    step: float = param(
        1.5,
        label="Step",
        help="Length of a step, in voxels of the level in use.",
        unit="voxel",
        ge=0.125,
        le=4,
        step=0.125,
    )
    stop: float = param(
        0.1, label="Early stop", help="Transmittance below which a ray ends.", unit="ratio", ge=0, le=0.2, step=0.005
    )
    first: float = param(
        2.5,
        label="First sample",
        help="How much longer the finest level's steps are in a picture's first sample, shown while the camera moves.",
        unit="ratio",
        ge=1,
        le=4,
        step=0.25,
    )

    pitch: int = param(
        2,
        label="Rays of the first sample",
        help="Pixels a side that share a ray in a picture's first sample, which is smoothed; 1: each has its own.",
        unit="px",
        cost="host",
        ge=1,
        le=2,
    )

    def first_pitch(self) -> int:
        """As chosen."""
        return self.pitch

    def first_sample(self) -> RayMarch:
        """Beside longer steps, less to see behind what hides the most: the noise of one sample is far greater."""
        if self.first == 1:
            return self
        return self.model_copy(update={"stop": max(self.stop, FIRST_STOP)})
