"""Points on the subject, evenly spread, and the way from a place on a triangle to its point.

Porquet 2005 splits triangles in four until their shortest side is below a limit. Here each triangle is cut at once
into n x n equal ones, n by its area, and each of these has its point in the middle: the point that a ray sees is then
found by arithmetic. Triangles smaller than a point's share have one together with their neighbours.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from scipy.spatial import cKDTree

from renderer.core.params import Model, bake_arguments, param
from renderer.core.technique import Arrays, Bake
from renderer.directional.morton import BITS, morton
from renderer.world.mesh_normals import face_vectors

GOLDEN = (np.sqrt(5) - 1) / 2

MOST_CUTS = 4095
"""Into how many parts the side of a triangle is cut: its point's number stays within 24 bits."""

APART = 2.0
"""Spacings for which the difference between two unit normals counts, when a triangle looks for a point near it."""


FARTHEST = 3.0
"""Spacings beyond which a triangle takes no other's point."""


class Cloud(Model):
    """The points on the subject."""

    points: int = param(
        1_500_000, label="Points", help="About how many there are on all of the surface.", unit="count", cost="bake",
        ge=1000, le=8_000_000, source="Porquet 2005",
    )
    position_bits: Literal[8, 10, 12, 16] = param(
        16, label="Bits of a position", help="For each of its coordinates, across the box.", unit="count", cost="host",
        source="Porquet 2005, whose points have 8",
    )


def bake_cloud(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """The points of a subject.

    Args:
        arguments: `points`, how many are wanted.
        inputs: `subject`.

    Returns:
        `position` (N, 3) float32 [m], `normal` (N, 3) float32 unit, `colour` (N, 3) float32 linear, `triangle` (N,)
        int32; `spacing` () float64 [m] between neighbours; `cuts` (F,) int32, into how many parts each side of a
        triangle is cut, and `first` (F, S) int32, its first point on the front and, of two-sided subjects, S = 2, on
        the back.
    """
    subject = inputs["subject"]
    if "source" in subject:
        return _given(subject)
    vertices, faces, two_sided = subject["vertices"], subject["faces"], bool(subject["two_sided"])
    vectors = face_vectors(vertices, faces)
    area = np.linalg.norm(vectors, axis=1) / 2
    share = float(area.sum()) * (2 if two_sided else 1) / int(arguments["points"])
    progress(0.1, "spreading points")
    own, first_own = _owners(vertices, faces, vectors, area, share)
    cuts = np.ones(len(faces), np.int32)
    cuts[own] = _cuts(area[own], share)
    counts = cuts[own].astype(np.int64) ** 2
    starts = np.cumsum(counts) - counts
    first = starts[first_own].astype(np.int32)
    triangle = np.repeat(own, counts)
    place = np.arange(len(triangle)) - np.repeat(starts, counts)
    u, v = _middles(place, np.repeat(cuts[own], counts))
    progress(0.4, "spreading points")
    weight = np.stack([1 - u - v, u, v], axis=1)
    corner = faces[triangle]
    position = np.zeros((len(triangle), 3))
    normal = np.zeros((len(triangle), 3))
    for k in range(3):
        position += weight[:, k, None] * vertices[corner[:, k]]
        normal += weight[:, k, None] * subject["normals"][triangle, k]
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    progress(0.8, "spreading points")
    made = {"position": position, "normal": normal, "colour": _mean_colours(subject["colour"], area, first_own, own,
                                                                            counts)}
    return _both_sides(made, triangle, first, two_sided) | {"spacing": np.asarray(np.sqrt(share)), "cuts": cuts}


def _given(subject: Arrays) -> dict[str, np.ndarray]:
    """The points of a user's cloud, as `bake_cloud` gives them: each has some faces, which surround it evenly."""
    source, faces = subject["source"], subject["faces"]
    count = int(source.max()) + 1
    vectors = face_vectors(subject["vertices"], faces)
    area = np.linalg.norm(vectors, axis=1)
    weight = np.bincount(source, area, count)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(source, area * values[:, k], count) for k in range(3)], axis=1) / weight[:, None]

    normal = mean(subject["normals"].mean(axis=1))
    made = {"position": mean(subject["vertices"][faces].mean(axis=1)), "colour": mean(subject["colour"]),
            "normal": normal / np.linalg.norm(normal, axis=1, keepdims=True)}
    triangle = np.zeros(count, np.int64)
    triangle[source[::-1]] = np.arange(len(source))[::-1]
    both = bool(subject["two_sided"])
    # A point's square has twice the area that is its share, and each triangle's cross product is the square's.
    return _both_sides(made, triangle, source, both) | {
        "spacing": np.asarray(np.sqrt(np.median(weight) / 4)), "cuts": np.ones(len(faces), np.int32)}


def _both_sides(
    made: dict[str, np.ndarray], triangle: np.ndarray, first: np.ndarray, two_sided: bool
) -> dict[str, np.ndarray]:
    """Points with their triangles and each triangle's first point, and again for the backs of two-sided subjects."""
    both = 2 if two_sided else 1
    result = {name: np.concatenate([values] * both).astype(np.float32) for name, values in made.items()}
    count = len(triangle)
    if two_sided:
        result["normal"][count:] *= -1
        first = np.stack([first, first + count], axis=1)
    result["triangle"] = np.concatenate([triangle] * both).astype(np.int32)
    result["first"] = first.reshape(-1, both).astype(np.int32)
    return result


def _cuts(area: np.ndarray, share: float) -> np.ndarray:
    """Into how many parts n the sides of triangles are cut, so that each of n^2 has about `share` [m2].

    Of like triangles some have n and the others n + 1, taking turns by the golden ratio: their sum is right.
    """
    wanted = np.maximum(area / share, 1.0)
    below = np.floor(np.sqrt(wanted))
    turn = (np.arange(len(area)) * GOLDEN) % 1
    return np.clip(below + (turn < (wanted - below**2) / (2 * below + 1)), 1, MOST_CUTS).astype(np.int32)


def _owners(
    vertices: np.ndarray, faces: np.ndarray, vectors: np.ndarray, area: np.ndarray, share: float
) -> tuple[np.ndarray, np.ndarray]:
    """Triangles that have points of their own (K,), and for each triangle which of these has its points (F,).

    Of triangles with less than a share, one has a point wherever a share's area has come together along a curve
    through space, and the others take the point of whichever of these is nearest, by place and by the way it looks.
    """
    owner = np.arange(len(faces))
    small = np.flatnonzero(area < share)
    if len(small):
        middle = vertices[faces[small]].mean(axis=1)
        order = np.argsort(_curve(middle, vectors[small], share), kind="stable")
        total = np.cumsum(area[small][order]) / share
        # One where the sum passes a half, and then at every whole share more: halfway along what it stands for.
        chosen = order[np.flatnonzero(np.diff(np.floor(total + 0.5), prepend=0))]
        chosen = chosen if len(chosen) else order[:1]
        length = np.linalg.norm(vectors[small], axis=1, keepdims=True)
        like = vectors[small] / np.where(length > 0, length, 1) * APART
        traits = np.concatenate([middle / np.sqrt(share), like], axis=1)
        away, nearest = cKDTree(traits[chosen]).query(traits)
        # One that stands alone has its own, whatever its size.
        owner[small] = np.where(away < FARTHEST, small[chosen[nearest]], small)
    own = np.unique(owner)
    return own, np.searchsorted(own, owner)


def _curve(middle: np.ndarray, vectors: np.ndarray, share: float) -> np.ndarray:
    """Places (F,) int64 of triangles along Morton's curve, those that look to one side of a box after another."""
    side = np.abs(vectors).argmax(axis=1)
    side = 2 * side + (np.take_along_axis(vectors, side[:, None], axis=1)[:, 0] > 0)
    return np.asarray(side.astype(np.int64) << 3 * BITS | morton(middle, np.sqrt(share) / 4))


def _middles(place: np.ndarray, cuts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Barycentric weights of corners 2 and 3 in the middle of part `place` of a triangle; undoes `part_of`."""
    row = np.minimum((cuts - np.sqrt(np.maximum(cuts.astype(np.float64) ** 2 - place, 0))).astype(np.int64), cuts - 1)
    row -= row * (2 * cuts - row) > place
    row += (row + 1) * (2 * cuts - row - 1) <= place
    within = place - row * (2 * cuts - row)
    third = (1 + within % 2) / 3
    return (row + third) / cuts, (within // 2 + third) / cuts


def part_of(u: np.ndarray, v: np.ndarray, cuts: np.ndarray) -> np.ndarray:
    """Number of the part of a triangle cut `cuts` times that holds a place.

    Rows of parts run along corner 3, row i beginning at u = i / cuts; within a row, parts that stand as the triangle
    does and parts that are turned take turns.

    Args:
        u, v: barycentric weights of corners 2 and 3; a place outside by rounding counts as on the edge.
        cuts: n; the triangle has n^2 parts.
    """
    x, y = np.clip(u, 0, 1) * cuts, np.clip(v, 0, 1) * cuts
    row = np.minimum(x.astype(np.int64), cuts - 1)
    column = np.minimum(y.astype(np.int64), cuts - 1 - row)
    turned = (x - row + y - column > 1) & (row + column < cuts - 1)
    return np.asarray(row * (2 * cuts - row) + 2 * column + turned)


def _mean_colours(
    colour: np.ndarray, area: np.ndarray, owner: np.ndarray, own: np.ndarray, counts: np.ndarray
) -> np.ndarray:
    """Colours (N, 3) of the points: the mean over all triangles that have them, by area."""
    weight = np.bincount(owner, area, len(own))
    mean = np.stack([np.bincount(owner, area * colour[:, k], len(own)) for k in range(3)], axis=1) / weight[:, None]
    return np.repeat(mean, counts, axis=0)


def rounded_positions(position: np.ndarray, box: np.ndarray, bits: int) -> np.ndarray:
    """Positions (N, 3) [m] as so many bits a coordinate keep them across the box."""
    low, extent = box[0], box[1] - box[0]
    steps = (1 << bits) - 1
    return np.asarray(low + np.rint((position - low) / extent * steps) / steps * extent)


def cloud_bake(cloud: Cloud, subject: Bake) -> Bake:
    """The points on a subject."""
    return Bake("cloud", bake_cloud, bake_arguments(cloud), (subject,), seconds=1 + cloud.points / 500_000)
