"""Conflicts of a shell, prisms inside out or over one another, and the local shortening that removes them.

After Peng, Kristjansson and Zorin 2004 ("Interactive modeling of topologically complex geometric detail") in spirit:
where the shell would meet itself it becomes thinner, by as much as is needed and with a gentle slope around. They get
the length from an averaged distance to the surface; here it is shortened until exact tests find no conflict.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from renderer.core.errors import LimitError
from renderer.shells.clamp_kernels import close_prisms, overlapping
from renderer.shells.shell import CORNERS, FLAT, SIGNS, sorted_faces
from renderer.world.mesh_normals import face_vectors

STEP = 0.85
"""Factor by which the offsets of a conflict are shortened at a time: what remains is at most that much too short."""

LEAST = 0.02
"""Share of its length below which no offset is shortened: what overlaps there lies where the mesh meets itself."""

SLOPE = 0.6
"""Metres by which the shell's thickness may change in a metre along the surface, around what was shortened."""

TOUCH = 1e-9
"""Share of the mesh's extent within which prisms only touch."""

FACING = 0.05
"""Cosine to the normals of its faces that an offset has at least, where that is possible."""

THICK = 0.1
"""Share of the mesh's extent beyond which a length counts as no more than that, for `LEAST`."""

MOST_PAIRS = 2_000_000
"""Pairs of prisms that are looked at closely, a few microseconds each in some twenty rounds."""

TURNS = 60
"""Steps in which such a direction is looked for."""


@dataclass(frozen=True)
class Conflicts:
    """Prisms that are not what they should be.

    Args:
        inverted: (N,) triangles whose prism has a cell inside out, or without an inside.
        overlaps: (M, 2) pairs of prisms that overlap.
    """

    inverted: np.ndarray
    overlaps: np.ndarray

    def prisms(self) -> np.ndarray:
        """Every prism of a conflict, once."""
        return np.unique(np.concatenate([self.inverted, self.overlaps.ravel()]))

    def __len__(self) -> int:
        return len(self.inverted) + len(self.overlaps)


@dataclass(frozen=True)
class Clamped:
    """Offsets after shortening.

    Args:
        share: (V,) of its wanted length that each vertex keeps.
        wanted, left: conflicts before and after.
        own: (M, 2) pairs of `wanted` that overlap however thin the shell is: the mesh meets itself there.
    """

    share: np.ndarray
    wanted: Conflicts
    left: Conflicts
    own: np.ndarray


class Prisms:
    """The prisms over a mesh, to look for conflicts at several offsets.

    Args:
        vertices: (V, 3) metres. faces: (F, 3).
    """

    def __init__(self, vertices: np.ndarray, faces: np.ndarray) -> None:
        lower, self._turn = sorted_faces(faces)
        self.vertices, self.faces = vertices, faces
        self.corners = np.concatenate([lower, lower + len(vertices)], axis=1).astype(np.int64)
        a, b = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
        self._edges = (a, b, SLOPE * np.linalg.norm(vertices[a] - vertices[b], axis=1))
        self._extent = float(np.ptp(vertices, axis=0).max())
        self._slack = TOUCH * self._extent

    def conflicts(self, offset: np.ndarray) -> Conflicts:
        """Conflicts at offsets (V, 3) [m].

        Raises:
            LimitError: too many pairs of prisms come near each other.
        """
        return Conflicts(self._inverted(offset), self._overlapping(self._close(offset), offset))

    def clamp(self, offset: np.ndarray) -> Clamped:
        """Shorten offsets (V, 3) [m] until no conflict is left but those that no length removes.

        Raises:
            LimitError: too many pairs of prisms come near each other.
        """
        share = np.ones(len(self.vertices))
        close = self._close(offset)
        wanted = left = Conflicts(self._inverted(offset), self._overlapping(close, offset))
        if not len(wanted):
            return Clamped(share, wanted, left, np.empty((0, 2), np.int32))
        own = _common(wanted.overlaps, self._overlapping(close, offset * TOUCH**0.5))
        length = np.linalg.norm(offset, axis=1)
        least = LEAST * min(1.0, THICK * self._extent / float(length.max()))
        stuck = self._inverted(offset * least)
        kept = self._overlapping(close, offset * least)
        close = _without(close, kept)
        overlaps = _without(wanted.overlaps, kept)
        while True:
            now = offset * share[:, None]
            bad = np.concatenate([np.setdiff1d(self._inverted(now), stuck), overlaps.ravel()])
            concerned = np.unique(self.faces[bad])
            concerned = concerned[share[concerned] > least]
            if not len(concerned):
                return Clamped(share, wanted, self.conflicts(now), own)
            before = share
            share = share.copy()
            share[concerned] = np.maximum(share[concerned] * STEP, least)
            share = np.maximum(self._gentle(share, length), least)
            active = (share != before)[self.faces].any(axis=1)
            again = active[close].any(axis=1)
            still = overlaps[~active[overlaps].any(axis=1)]
            overlaps = np.concatenate([still, self._overlapping(close[again], offset * share[:, None])])

    def _positions(self, offset: np.ndarray) -> np.ndarray:
        return np.concatenate([self.vertices, self.vertices + offset])

    def _inverted(self, offset: np.ndarray) -> np.ndarray:
        """Triangles whose prism has a cell inside out, or without an inside, (N,)."""
        cells = self._positions(offset)[self.corners[:, CORNERS]]
        a, b, c = (cells[..., k, :] - cells[..., 0, :] for k in (1, 2, 3))
        determinant = np.einsum("fck,fck->fc", a, np.cross(b, c)) * SIGNS * self._turn[:, None]
        longest = np.maximum.reduce([np.einsum("fck,fck->fc", edge, edge) for edge in (a, b, c)]) ** 1.5
        return np.flatnonzero((determinant <= 6 * FLAT * longest).any(axis=1))

    def _close(self, offset: np.ndarray) -> np.ndarray:
        """Pairs (N, 2) of prisms that may overlap at these offsets, or at shorter ones."""
        pairs: np.ndarray = close_prisms(self._positions(offset), self.corners, self._slack, MOST_PAIRS)
        if len(pairs) > MOST_PAIRS:
            raise LimitError(
                "extrusion.thickness", f"brings more than {MOST_PAIRS:,} pairs of prisms together", "a thinner shell"
            )
        return pairs

    def _overlapping(self, pairs: np.ndarray, offset: np.ndarray) -> np.ndarray:
        found: np.ndarray = pairs[overlapping(self._positions(offset)[self.corners], pairs, self._slack)]
        return found

    def _gentle(self, share: np.ndarray, length: np.ndarray) -> np.ndarray:
        """Shares lowered around what was shortened, so that there the thickness changes by `SLOPE` at most."""
        a, b, rise = self._edges
        cap = np.where(share < 1, share * length, np.inf)
        while True:
            lower = cap.copy()
            np.minimum.at(lower, a, cap[b] + rise)
            np.minimum.at(lower, b, cap[a] + rise)
            # A cap above the offset's own length changes nothing, and goes no further.
            lower[lower >= length] = np.inf
            if not (lower < cap - 1e-9 * length).any():
                kept: np.ndarray = np.minimum(length, cap) / np.where(length > 0, length, 1)
                return np.where(length > 0, kept, share)
            cap = np.minimum(lower, cap)


def facing_directions(direction: np.ndarray, vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions turned until they look to the front of every face around their vertex, where one direction can.

    A prism that starts towards the back of its triangle is inside out however thin it is. The direction whose least
    cosine to some unit vectors is largest is that of the point of their convex hull nearest to 0 (Gilbert 1966): each
    step goes towards the normal that is faced least, as far as brings it nearest.

    Args:
        direction: (V, 3) unit vectors. vertices: (V, 3). faces: (F, 3).

    Returns:
        (V, 3) unit vectors, and which of them were turned, (V,) bool.
    """
    vectors = face_vectors(vertices, faces)
    normal = vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300)
    corner, around = faces.ravel(), np.repeat(np.arange(len(faces)), 3)
    point = direction.copy()
    found = direction.copy()

    def faced(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Least cosine at each vertex, and the face to which it is."""
        unit = points / np.maximum(np.linalg.norm(points, axis=1, keepdims=True), 1e-300)
        cosine = np.einsum("nk,nk->n", unit[corner], normal[around])
        order = np.lexsort((cosine, corner))
        _, first = np.unique(corner[order], return_index=True)
        return cosine[order[first]], around[order[first]]

    best, face = faced(found)
    low = best < FACING
    start = best
    for _ in range(TURNS if low.any() else 0):
        way = normal[face] - point
        reach = np.einsum("vk,vk->v", way, -point) / np.maximum(np.einsum("vk,vk->v", way, way), 1e-300)
        point = point + np.where(low, np.clip(reach, 0, 1), 0)[:, None] * way
        now, face = faced(point)
        size = np.linalg.norm(point, axis=1)
        # At 0 no direction is left: the normals look all ways.
        better = low & (now > best) & (size > 1e-9)
        found[better] = point[better] / size[better, None]
        best = np.where(better, now, best)
    return found, best > start


def _key(pairs: np.ndarray) -> np.ndarray:
    return pairs[:, 0].astype(np.int64) * (1 << 32) + pairs[:, 1]


def _without(pairs: np.ndarray, others: np.ndarray) -> np.ndarray:
    kept: np.ndarray = pairs[~np.isin(_key(pairs), _key(others))]
    return kept


def _common(pairs: np.ndarray, others: np.ndarray) -> np.ndarray:
    kept: np.ndarray = pairs[np.isin(_key(pairs), _key(others))]
    return kept
