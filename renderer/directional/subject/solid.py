"""The mesh of a subject, as its maker gives it and as points and rays take it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from renderer.directional.morton import morton
from renderer.world.mesh_normals import corner_normals, face_vectors

FLATTEST = 4.0
"""Times its height that a triangle's longest side may be: points on a thinner one would stand in rows."""

FINEST = 256
"""Into how many parts of the box's diagonal no side is cut."""

ROUNDS = 16
"""Of cutting longest sides in halves; each needs a side twice as long as the last."""


@dataclass(frozen=True)
class Solid:
    """Triangles with colour and shading normals.

    Attributes:
        vertices: (V, 3) float64 [m], z up. faces: (F, 3), counter-clockwise seen from the front.
        colour: (F, 3) linear reflectance.
        normals: (F, 3, 3) unit shading normals of the corners; None takes smooth ones.
        two_sided: whether the back of a face is seen too.
        source: (F,) point of the user's cloud that a face stands for; None for true meshes.
        notes: what was assumed, in words.
        lift: how far off the surface what looks for light begins [m]: squares that stand for points rise over one
            another by about their width where the surface bends, and would be in each other's light.
    """

    vertices: np.ndarray
    faces: np.ndarray
    colour: np.ndarray
    normals: np.ndarray | None = None
    two_sided: bool = False
    source: np.ndarray | None = None
    notes: tuple[str, ...] = field(default_factory=tuple)
    lift: float = 0.0

    def stood(self, size: float) -> Solid:
        """Scaled so that the longest side of its box is `size` [m], its foot's middle at the origin; 0 leaves it."""
        if size == 0:
            return self
        used = self.vertices[np.unique(self.faces)]
        low, high = used.min(axis=0), used.max(axis=0)
        foot = np.array([*((low + high) / 2)[:2], low[2]])
        scale = float(size / (high - low).max())
        return replace(self, vertices=(self.vertices - foot) * scale, lift=self.lift * scale)

    def shaded(self) -> np.ndarray:
        """(F, 3, 3) its shading normals."""
        return corner_normals(self.vertices, self.faces) if self.normals is None else self.normals


def compact(solid: Solid) -> Solid:
    """The same surface without faces of no area, its long thin triangles cut across."""
    used = solid.vertices[solid.faces.ravel()]
    finest = float(np.linalg.norm(np.ptp(used, axis=0))) / FINEST
    area = np.linalg.norm(face_vectors(solid.vertices, solid.faces), axis=1)
    vertices, source = solid.vertices, np.flatnonzero(area > 0)
    faces, normals = solid.faces[source], solid.shaded()[source]
    done: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
    for _ in range(ROUNDS):
        corners = vertices[faces]
        sides = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
        length = sides.max(axis=1)
        height = np.linalg.norm(face_vectors(vertices, faces), axis=1) / length
        thin = (length > FLATTEST * height) & (length > finest)
        done.append((faces[~thin], normals[~thin], source[~thin]))
        if not thin.any():
            break
        vertices, faces, normals = _halved(vertices, faces[thin], normals[thin], sides[thin].argmax(axis=1))
        source = np.concatenate([source[thin]] * 2)
    else:
        done.append((faces, normals, source))
    faces, normals, source = (np.concatenate(parts) for parts in zip(*done))
    order = _order(vertices[faces].mean(axis=1), source)
    faces, normals, source = faces[order], normals[order], source[order]
    return replace(solid, vertices=vertices, faces=faces.astype(np.int32), normals=normals,
                   colour=solid.colour[source], source=None if solid.source is None else solid.source[source])


def _order(middle: np.ndarray, source: np.ndarray) -> np.ndarray:
    """Order (F,) of faces by their middles (F, 3), so that neighbouring points get neighbouring numbers and what texels
    see packs well: that of the whole faces they are parts of, or Morton's curve where it goes from each to a nearer
    one."""
    given = np.argsort(source, kind="stable")
    steps = np.linalg.norm(np.diff(middle[given], axis=0), axis=1)
    curve = np.argsort(morton(middle, max(float(np.median(steps)), 1e-9 * float(np.ptp(middle)))), kind="stable")
    along = np.linalg.norm(np.diff(middle[curve], axis=0), axis=1)
    return curve if along.sum() < steps.sum() else given


def _halved(
    vertices: np.ndarray, faces: np.ndarray, normals: np.ndarray, side: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Faces cut from the middle of the side that begins at corner `side` (F,): vertices, first and second halves, and
    the normals of their corners."""
    rows = np.arange(len(faces))[:, None]
    turn = (side[:, None] + np.arange(3)) % 3
    a, b, c = faces[rows, turn].T
    na, nb, nc = np.moveaxis(normals[rows, turn], 1, 0)
    nm = na + nb
    length = np.linalg.norm(nm, axis=1, keepdims=True)
    nm = np.where(length > 1e-9, nm / np.maximum(length, 1e-9), na)
    # The middle of a side comes out the same from both of its faces, to the last bit: a + b does not depend on order.
    m = len(vertices) + np.arange(len(faces))
    return (
        np.concatenate([vertices, (vertices[a] + vertices[b]) / 2]),
        np.concatenate([np.stack([a, m, c], axis=1), np.stack([m, b, c], axis=1)]),
        np.concatenate([np.stack([na, nm, nc], axis=1), np.stack([nm, nb, nc], axis=1)]),
    )
