"""Rays through prisms of constant extinction and colour: in closed form, and by the steps that drawing takes.

Each prism is the three tetrahedra of its corners (Dufort 2005, section 3.1), so its sides need not be flat.
Emission and absorption along a ray: dL/dt = sum of sigma (c - L) over the solids that are there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

TETS = np.array([[0, 1, 2, 5], [0, 1, 4, 5], [0, 3, 4, 5]])
"""Corners of the three tetrahedra among the base's three and their displaced copies (Dufort 2005, section 3.1)."""

FLAT = 1e-14
"""Volume over the product of three edges below which a tetrahedron has no inside."""


@dataclass(frozen=True)
class Crossings:
    """What R rays meet of P prisms.

    Attributes:
        begin, end: (R, 3P) distances at which each ray enters and leaves each tetrahedron, inf and inf where it misses.
        first, last: (R, P) the same of each prism, NaN where it is missed.
    """

    begin: Floats
    end: Floats
    first: Floats
    last: Floats

    @property
    def order(self) -> NDArray[np.int64]:
        """Prisms front to back by their entries, (R, P); -1 behind those that are met."""
        order = np.argsort(np.where(np.isnan(self.first), np.inf, self.first), axis=1, kind="stable")
        return np.where(np.isnan(np.take_along_axis(self.first, order, axis=1)), -1, order)


def crossings(corners: Floats, origins: Floats, directions: Floats) -> Crossings:
    """Intersect rays with prisms.

    Args:
        corners: (P, 6, 3), base and displaced copy. origins, directions: (R, 3), the latter unit.
    """
    tets = corners[:, TETS].reshape(-1, 4, 3)
    begin, end = np.zeros((len(origins), len(tets))), np.full((len(origins), len(tets)), np.inf)
    edges = tets[:, 1:] - tets[:, :1]
    flat = np.abs(np.linalg.det(edges)) <= FLAT * np.prod(np.linalg.norm(edges, axis=2), axis=1)
    for k in range(4):
        a, b, c = (tets[:, n] for n in range(4) if n != k)
        normal = np.cross(b - a, c - a)
        inward = np.sign(np.einsum("ti,ti->t", normal, tets[:, k] - a))
        normal *= inward[:, None]
        slope = directions @ normal.T
        # from the face itself, and not from the axes' origin: nothing large cancels
        height = np.einsum("rti,ti->rt", origins[:, None] - a, normal)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -height / slope
        begin = np.where(slope > 0, np.maximum(begin, t), begin)
        end = np.where(slope < 0, np.minimum(end, t), np.where((slope == 0) & (height < 0), -1.0, end))
    met = (begin < end) & ~flat
    begin, end = np.where(met, begin, np.inf), np.where(met, end, np.inf)
    parts = met.reshape(len(origins), -1, 3)
    first = np.where(parts, begin.reshape(parts.shape), np.inf).min(axis=2, initial=np.inf)
    last = np.where(parts, end.reshape(parts.shape), -np.inf).max(axis=2, initial=-np.inf)
    missed = ~parts.any(axis=2)
    return Crossings(begin, end, np.where(missed, np.nan, first), np.where(missed, np.nan, last))


def exact(found: Crossings, extinction: Floats, colour: Floats) -> tuple[Floats, Floats]:
    """Radiance (R, 3) and opacity (R,), each stretch between two borders in closed form.

    Args:
        extinction: (P,) 1/m. colour: (P, 3) radiance of matter that hides everything behind it.
    """
    borders = np.sort(np.concatenate([found.begin, found.end], axis=1), axis=1)
    with np.errstate(invalid="ignore"):
        length = np.diff(borders, axis=1)
        middle = 0.5 * (borders[:, 1:] + borders[:, :-1])
    length = np.where(np.isfinite(length), length, 0.0)
    return _run(found, np.where(np.isfinite(middle), middle, -1.0), length, length, extinction, colour)


def march(
    found: Crossings, extinction: Floats, colour: Floats, steps: int, reference_length: float | None, weighted: bool
) -> tuple[Floats, Floats]:
    """The same by equal steps from the first border to the last, what is at each step's middle added up.

    Args:
        steps: on the way. reference_length: for which the opacity counts whatever a step's length is; None corrects it.
        weighted: whether colour counts by its opacity; Dufort 2005 prints the sum (5.1) without (erratum 002-1).
    """
    met = np.isfinite(found.begin)
    near = np.where(met.any(axis=1), found.begin.min(axis=1, initial=np.inf), 0.0)
    far = np.where(met, found.end, -np.inf).max(axis=1, initial=-np.inf)
    step = np.where(met.any(axis=1), far - near, 0.0)[:, None] / steps
    middle = near[:, None] + (np.arange(steps) + 0.5) * step
    length = np.broadcast_to(step, middle.shape)
    counted = length if reference_length is None else np.where(length > 0, reference_length, 0.0)
    return _run(found, middle, length, counted, extinction, colour, weighted)


def _run(
    found: Crossings, middle: Floats, length: Floats, counted: Floats, extinction: Floats, colour: Floats,
    weighted: bool = True,
) -> tuple[Floats, Floats]:
    """Composite stretches front to back: `counted` metres of what is at the middle of each."""
    radiance, left = np.zeros((len(middle), 3)), np.ones(len(middle))
    emitted = extinction[:, None] * colour
    for n in range(middle.shape[1]):
        t = middle[:, n, None]
        there = ((found.begin <= t) & (t < found.end)).reshape(len(middle), -1, 3).any(axis=2)
        total = there @ extinction
        hidden = -np.expm1(-total * counted[:, n]) * (length[:, n] > 0)
        weight = hidden if weighted else 1.0
        radiance += (left * weight / np.maximum(total, 1e-300))[:, None] * (there @ emitted)
        left *= 1 - hidden
    return radiance, 1 - left


def segments(
    found: Crossings, extinction: Floats, colour: Floats, steps: int, reference_length: float | None, weighted: bool
) -> tuple[Floats, Floats]:
    """The same as cells are drawn: tetrahedra by their entries, each one's segment alone in equal steps.

    Args:
        steps: of each segment. reference_length, weighted: as in `march`.
    """
    radiance, left = np.zeros((len(found.begin), 3)), np.ones(len(found.begin))
    order = np.argsort(found.begin, axis=1, kind="stable")
    for rank in range(order.shape[1]):
        tet = order[:, rank]
        begin, end = (np.take_along_axis(a, tet[:, None], axis=1)[:, 0] for a in (found.begin, found.end))
        met = np.isfinite(begin)
        length = np.where(met, np.where(met, end, 1.0) - np.where(met, begin, 1.0), 0.0) / steps
        counted = length if reference_length is None else np.where(met, reference_length, 0.0)
        hidden = -np.expm1(-extinction[tet // 3] * counted)
        weight = hidden if weighted else np.where(met, 1.0, 0.0)
        for _ in range(steps):
            radiance += (left * weight)[:, None] * colour[tet // 3]
            left *= 1 - hidden
    return radiance, 1 - left
