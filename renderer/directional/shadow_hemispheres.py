"""Shadow hemispheres by ray casting: which directions of light each point of the cloud sees past the subject.

Porquet 2005, section on self-shadowing: a point's hemisphere about its normal is cut into directions, and each holds
1 where light from there arrives, 0 where the subject is in its way.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.core.technique import Arrays
from renderer.directional.frames import frames, quantised
from renderer.directional.hemisphere import Hemisphere, hemisphere_of
from renderer.directional.mesh_rays import MeshRays

Progress = Callable[[float, str], None]

LIFT = 1e-4
"""How far above its point a ray starts, in diagonals of the subject: more than what rounding moves a stored place."""

RAYS = 1 << 19
"""Cast at once: what they hold fits into a cache, and progress is told often enough to stop quickly."""


class Caster:
    """Asks whether rays meet a mesh.

    Args:
        vertices: (V, 3) [m]. faces: (F, 3).
    """

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        self.lift = LIFT * float(np.linalg.norm(np.ptp(vertices, axis=0)))
        self._rays = MeshRays(vertices, faces)

    def open(self, positions: np.ndarray, normals: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """Whether nothing lies along directions (N, k, 3) from positions (N, 3) [m] a little off along normals (N, 3):
        (N, k) booleans."""
        return ~self._rays.blocked(positions + self.lift * normals, directions)


def world_directions(normals: np.ndarray, local: np.ndarray) -> np.ndarray:
    """Directions (N, k, 3) float32 in the world of local ones (k, 3) or (N, k, 3) about unit normals (N, 3)."""
    axes = np.stack([*frames(normals), normals], axis=1).astype(np.float32)
    return np.asarray(local.astype(np.float32) @ axes)


def cosine_weights(layout: Hemisphere) -> np.ndarray:
    """(count,) share of an even sky's irradiance that comes from each cell, 1 together: integrals of the cosine."""
    edges = np.sin(np.arange(layout.elevations + 1) * layout.step) ** 2
    return np.append(np.repeat(np.diff(edges) / layout.azimuths, layout.azimuths), 1 - edges[-1])


def shadow_bits(
    caster: Caster, positions: np.ndarray, normals: np.ndarray, layout: Hemisphere, progress: Progress
) -> tuple[np.ndarray, np.ndarray]:
    """Hemispheres of points about their normals, which the GPU must hold as they are given.

    Args:
        positions: (N, 3) [m]. normals: (N, 3) unit.

    Returns:
        Bits (N, ceil(count/8)) uint8 in the order of the directions, the first in a byte's lowest bit, 1 where light
        arrives; openness (N,) float32, their cosine-weighted share.

    Raises:
        Cancelled: by `progress`.
    """
    local, weights = layout.directions(), cosine_weights(layout)
    bits = np.empty((len(positions), -(-layout.count // 8)), np.uint8)
    openness = np.empty(len(positions), np.float32)
    step = max(RAYS // layout.count, 1)
    for start in range(0, len(positions), step):
        progress(start / len(positions), "rays to the light")
        part = slice(start, start + step)
        seen = caster.open(positions[part], normals[part], world_directions(normals[part], local))
        bits[part] = np.packbits(seen, axis=1, bitorder="little")
        openness[part] = seen @ weights.astype(np.float32)
    return bits, openness


def unpacked(bits: np.ndarray, count: int) -> np.ndarray:
    """Booleans (N, count) of packed bits (N, ceil(count/8))."""
    return np.unpackbits(bits, axis=1, count=count, bitorder="little").astype(bool)


def bake_shadows(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Progress) -> dict[str, np.ndarray]:
    """Hemispheres of all points that a texel sees.

    Args:
        arguments: directions of a hemisphere.
        inputs: subject, cloud and visibility.

    Returns:
        `bits` and `openness` of the used points; see `shadow_bits`.
    """
    layout = hemisphere_of(int(arguments["directions"]))
    subject, used = inputs["subject"], inputs["visibility"]["used"]
    caster = Caster(subject["vertices"], subject["faces"])
    caster.lift += float(subject.get("lift", 0.0))
    positions = inputs["cloud"]["position"][used]
    normals = quantised(inputs["cloud"]["normal"][used].astype(np.float64))
    bits, openness = shadow_bits(caster, positions, normals, layout, progress)
    return {"bits": bits, "openness": openness}
