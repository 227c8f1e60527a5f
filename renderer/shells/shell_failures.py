"""Where shells themselves fail: the numbers and charts of their cases."""

from __future__ import annotations

import numpy as np

from renderer.core.failure import Charted, Curve
from renderer.shells.extrusion import Extrusion, extrude
from renderer.shells.shell import build_shell
from renderer.shells.surfaces import Mushroom

THICKNESSES = (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3)
"""Of the shell, metres; the last is the case's own."""

POINTS = 1500
"""In which cells are counted."""


def concave_surface() -> Charted:
    """How much of a mushroom's shell lies within itself, as thick as it was asked for and clamped."""
    thickness = np.array(THICKNESSES)
    found = {clamp: np.array([_overlap(float(one), clamp) for one in thickness]) for clamp in (False, True)}
    curves = (Curve("failing", thickness, found[False]), Curve("surviving", thickness, found[True]))
    wrong, right = (float(found[clamp][-1]) for clamp in (False, True))
    return Charted(wrong, right, curves, "thickness asked for, m", "share in two cells at once")


def _overlap(thickness: float, clamp: bool) -> float:
    mesh = Mushroom(around=20, along=18).mesh()
    shell = build_shell(mesh, extrude(mesh, Extrusion(thickness=thickness, clamp=clamp)).offset)
    return share_twice(shell.positions[shell.tets], POINTS)


def share_twice(corners: np.ndarray, points: int = 1500, seed: int = 1) -> float:
    """Share of the volume of tetrahedra (T, 4, 3) that lies in another of them too, inside out or not.

    Args:
        points: by chance, spread evenly over all volumes; the share's standard error is at most 0.5 / sqrt(points).
    """
    rng = np.random.default_rng(seed)
    edges = corners[:, 1:] - corners[:, :1]
    volume = np.abs(np.linalg.det(edges))
    solid = np.flatnonzero(volume > 1e-12 * volume.max())
    chosen = rng.choice(solid, points, p=volume[solid] / volume[solid].sum())
    places = np.einsum("nk,nkj->nj", rng.dirichlet(np.ones(4), points), corners[chosen])
    inverse = np.linalg.inv(edges[solid])
    start = corners[solid, 0]
    twice = 0
    for place in places:
        weights = np.einsum("tj,tjk->tk", place - start, inverse)
        inside = (weights > 1e-9).all(axis=1) & (weights.sum(axis=1) < 1 - 1e-9)
        twice += int(inside.sum() > 1)
    return twice / points
