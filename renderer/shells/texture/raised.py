"""Matter under a height function."""

from __future__ import annotations

import numpy as np

from renderer.shells.texture.block import Matter
from renderer.shells.texture.source import Procedure, unit, with_glow


def normals_of_height(height: np.ndarray, step: float) -> np.ndarray:
    """Unit normals (J, I, 3) of a periodic height (J, I) on nodes `step` apart."""
    east = (np.roll(height, -1, axis=1) - np.roll(height, 1, axis=1)) / (2 * step)
    north = (np.roll(height, -1, axis=0) - np.roll(height, 1, axis=0)) / (2 * step)
    return unit(np.stack([-east, -north, np.ones_like(height)], axis=-1).astype(np.float32))


def under(source: Procedure, height: np.ndarray, tint: np.ndarray, opacity: np.ndarray | float = 1.0) -> Matter:
    """Matter up to a height: the first material, its normals those of the surface above.

    Args:
        source: whose voxels are filled.
        height: (J, I), where the shell is 1 high.
        tint: (J, I, 3) or (K, J, I, 3), reflectance.
        opacity: of a full voxel.
    """
    step = 1.0 / source.layers
    normal = normals_of_height(height, step)
    # The vertical distance times the normal's own z: that to the tangent plane.
    distance = (source.centres()[2] - height) * normal[..., 2]
    cover = source.covered(distance)
    colour = np.empty((*source.shape, 4), np.float32)
    colour[..., :3] = np.clip(tint, 0.0, 1.0)
    colour[..., 3] = cover * opacity
    return Matter(colour, with_glow(np.broadcast_to(normal, (*source.shape, 3))), (cover > 0).astype(np.uint8))
