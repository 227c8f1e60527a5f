"""The subject's triangles in Embree (Wald et al. 2014): what a ray meets, and whether anything is in its way.

Embree counts in float32. Rays are moved to the subject first and measured from its middle, so that its rounding is a
ten-millionth of the subject; where a ray meets a face is then put together from the face's corners in float64.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from renderer.reference.directional_world import DirectionalWorld, Floats

OFF = 1e-5
"""How far off a face a ray begins, in diagonals of the subject's box: a hundred times what Embree rounds by."""

BATCH = 1 << 18
"""Rays that are traced at once."""

MISS = -1


@dataclass(frozen=True)
class Hits:
    """Where rays met the subject, M of them.

    Attributes:
        place: (M, 3) metres. start: the same, moved off the face to the normal's side.
        normal: (M, 3) unit, interpolated, turned where the subject is two-sided. colour: (M, 3).
        to_eye: (M, 3) unit.
    """

    place: Floats
    start: Floats
    normal: Floats
    colour: Floats
    to_eye: Floats


class Subject:
    """The triangles of a world, those without an area left out."""

    def __init__(self, world: DirectionalWorld) -> None:
        corners = np.asarray(world.vertices, np.float64)[world.faces]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(across, axis=1)
        whole = area > 0
        self.corners, self.face_normals = corners[whole], across[whole] / area[whole, None]
        self.normals = np.asarray(world.normals, np.float64)[whole]
        self.colour = np.asarray(world.colour, np.float64)[whole]
        self.two_sided, self._lift = world.two_sided, world.lift
        low, high = corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)
        self.middle, self.diagonal = (low + high) / 2, float(np.linalg.norm(high - low))
        self._scene = EmbreeScene()
        # Embree keeps no copy: the mesh and its buffer must live as long as the scene
        self._buffer = np.ascontiguousarray(self.corners - self.middle, np.float32)
        self._mesh = TriangleMesh(self._scene, self._buffer)

    def met(self, origins: Floats, directions: Floats) -> tuple[NDArray[np.bool_], Hits]:
        """Which of M rays meet the subject, and where these do."""
        from_middle = origins - self.middle
        ahead = np.maximum(-np.einsum("md,md->m", from_middle, directions) - self.diagonal, 0)
        begun = (from_middle + ahead[:, None] * directions).astype(np.float32)
        parts = [
            self._scene.run(np.ascontiguousarray(o), np.ascontiguousarray(d), output=True)
            for o, d in zip(_batches(begun), _batches(directions.astype(np.float32)), strict=True)
        ]
        face, u, v = (np.concatenate([part[name] for part in parts]) for name in ("primID", "u", "v"))
        hit = face != MISS
        face = face[hit].astype(np.int64)
        shares = np.stack([1.0 - u[hit] - v[hit], u[hit], v[hit]], axis=1).astype(np.float64)
        place = np.einsum("mc,mcd->md", shares, self.corners[face])
        normal = _unit(np.einsum("mc,mcd->md", shares, self.normals[face]))
        side = self.face_normals[face]
        side = np.where(np.einsum("md,md->m", side, normal)[:, None] < 0, -side, side)
        if self.two_sided:
            behind = np.einsum("md,md->m", side, directions[hit])[:, None] > 0
            normal, side = np.where(behind, -normal, normal), np.where(behind, -side, side)
        start = place + (OFF * self.diagonal + self._lift) * side
        return hit, Hits(place, start, normal, self.colour[face], -directions[hit])

    def blocked(self, origins: Floats, directions: Floats, reach: Floats | None = None) -> NDArray[np.bool_]:
        """Whether anything stands in the way of M rays, or within their reach of (M,) metres."""
        begun, along = (origins - self.middle).astype(np.float32), directions.astype(np.float32)
        ends = None if reach is None else reach.astype(np.float32)
        found = []
        for first in range(0, len(begun), BATCH):
            part = slice(first, first + BATCH)
            limits = {} if ends is None else {"dists": np.ascontiguousarray(ends[part])}
            found.append(self._scene.run(begun[part], along[part], query="OCCLUDED", **limits) != MISS)
        return np.concatenate(found) if found else np.zeros(0, np.bool_)

    def openness(self, hits: Hits, side: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
        """Cosine-weighted share of the hemisphere about each normal that is open, and the variance of its estimate.

        `side` squared strata, one ray each; the difference of neighbouring strata stands in for repeated draws.
        """
        count = side * side
        tangent, bitangent = frames(hits.normal)
        share, variance = np.zeros(len(hits.place)), np.zeros(len(hits.place))
        step = max(1, BATCH // count)
        row, column = np.divmod(np.arange(count), side)
        for first in range(0, len(share), step):
            some = slice(first, first + step)
            draws = rng.random((2, len(share[some]), count))
            radius, turn = np.sqrt((row + draws[0]) / side), 2 * math.pi * (column + draws[1]) / side
            axes = (tangent[some, None], bitangent[some, None], hits.normal[some, None])
            local = (radius * np.cos(turn), radius * np.sin(turn), np.sqrt(np.maximum(1 - radius**2, 0)))
            towards = sum(axis * part[..., None] for axis, part in zip(axes, local, strict=True))
            begun = np.broadcast_to(hits.start[some, None], towards.shape)
            free = ~self.blocked(begun.reshape(-1, 3), np.asarray(towards).reshape(-1, 3)).reshape(-1, count)
            share[some] = free.mean(axis=1)
            variance[some] = (free[:, 0::2] != free[:, 1::2]).sum(axis=1) / count**2
        return share, variance


def frames(normals: Floats) -> tuple[Floats, Floats]:
    """Tangents and bitangents (M, 3) of unit normals (Duff et al. 2017): the frame that azimuths are counted in."""
    x, y, z = normals.T
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    xy = x * y * a
    tangent = np.column_stack([1.0 + sign * x * x * a, sign * xy, -sign * x])
    return tangent, np.cross(normals, tangent)


def _unit(vectors: Floats) -> Floats:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-300)


def _batches(rays: NDArray[np.float32]) -> list[NDArray[np.float32]]:
    return [rays[first : first + BATCH] for first in range(0, len(rays), BATCH)]
