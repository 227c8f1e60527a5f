"""A mesh under rays (Embree: Wald et al. 2014), in float32 about its middle."""

from __future__ import annotations

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene


class MeshRays:
    """Asks what rays meet of a mesh.

    Args:
        vertices: (V, 3) [m]. faces: (F, 3).
    """

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        self._middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
        self._scene = EmbreeScene()
        # Kept: Embree reads the mesh's own memory.
        self._mesh = TriangleMesh(
            self._scene, (vertices - self._middle).astype(np.float32), np.ascontiguousarray(faces, np.int32)
        )

    def met(self, origins: np.ndarray, towards: np.ndarray) -> dict[str, np.ndarray]:
        """What rays from origins (N, 3) [m] along (N, 3) or (3,) meet first: `primID`, -1 where nothing, with `u`, `v`
        and `Ng` there."""
        begin = self._about_middle(origins)
        ways = np.ascontiguousarray(np.broadcast_to(towards, begin.shape), np.float32)
        found: dict[str, np.ndarray] = self._scene.run(begin, ways, query="INTERSECT", output=True)
        return found

    def blocked(self, origins: np.ndarray, towards: np.ndarray) -> np.ndarray:
        """Whether rays from origins (N, 3) [m], along k directions (N, k, 3) from each, meet anything: (N, k)."""
        begin = np.repeat(self._about_middle(origins), towards.shape[1], axis=0)
        ways = np.ascontiguousarray(towards.reshape(-1, 3), np.float32)
        met = self._scene.run(begin, ways, query="OCCLUDED")
        return np.asarray(met >= 0).reshape(towards.shape[:2])

    def _about_middle(self, origins: np.ndarray) -> np.ndarray:
        return np.ascontiguousarray(origins - self._middle, np.float32)
