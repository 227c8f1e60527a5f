"""Ray marching of the canopy layer."""

from __future__ import annotations

from typing import ClassVar, Literal

from renderer.core.params import param
from renderer.forest.technique import ForestTechnique


class RayMarch(ForestTechnique):
    """Samples the canopy along each ray, front to back; skips what is empty, stops when nothing shows through."""

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
