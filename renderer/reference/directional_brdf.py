"""Lookup of measured BRDFs in float64: tables between nodes, and MERL's files in their own coordinates.

Porquet 2005 looks a table up by five bilinear interpolations, four by the light's angles and one by the eye's; here
the same is one sum over the corners of a cell of four dimensions (three where only the difference of azimuths counts),
each weighed by the product of its shares. At the zenith all azimuths are one direction (errata 003-4), by the table's
own making.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from renderer.reference.directional_world import Floats, Merl, Table

TURN = 2 * math.pi

Ends = tuple[NDArray[np.signedinteger], NDArray[np.signedinteger], Floats]
"""Nodes before and behind a place, and the share of the latter."""


def reflected(brdf: Table | Merl, to_eye: Floats, to_light: Floats) -> Floats:
    """BRDF (M, 3) [1/sr] for unit directions (M, 3) along tangent, bitangent and normal; the horizon clamps both."""
    eye, light = _raised(to_eye), _raised(to_light)
    return _merl(brdf, eye, light) if isinstance(brdf, Merl) else _table(brdf, eye, light)


def _raised(directions: Floats) -> Floats:
    """Directions, those below the horizon moved up onto it."""
    up = directions * [1, 1, 0] + np.maximum(directions * [0, 0, 1], 0)
    length = np.linalg.norm(up, axis=1, keepdims=True)
    # straight down has no azimuth; any will do
    return np.where(length > 1e-12, up / np.maximum(length, 1e-12), [1.0, 0.0, 0.0])


def _table(table: Table, eye: Floats, light: Floats) -> Floats:
    theta = [np.arccos(np.clip(each[:, 2], 0, 1)) for each in (eye, light)]
    phi = [np.arctan2(each[:, 1], each[:, 0]) for each in (eye, light)]
    axes = [_between(table.theta_o, theta[0])]
    if table.phi_o is None:
        axes += [_between(table.theta_l, theta[1]), _around(table.phi_l, phi[1] - phi[0])]
    else:
        axes += [_around(table.phi_o, phi[0]), _between(table.theta_l, theta[1]), _around(table.phi_l, phi[1])]
    found = np.zeros((len(eye), 3))
    for corner in itertools.product((0, 1), repeat=len(axes)):
        weight = math.prod(share if side else 1 - share for side, (_, _, share) in zip(corner, axes, strict=True))
        index = tuple(ends[side] for side, (*ends, _) in zip(corner, axes, strict=True))
        found += np.asarray(weight)[:, None] * table.values[index]
    return found


def _between(nodes: NDArray[np.floating], at: Floats) -> Ends:
    """On a line: the first node and the last count beyond them."""
    at = np.clip(at, nodes[0], nodes[-1])
    above = np.clip(np.searchsorted(nodes, at), 1, max(len(nodes) - 1, 1))
    if len(nodes) == 1:
        return np.zeros_like(above), np.zeros_like(above), np.zeros(len(at))
    return above - 1, above, (at - nodes[above - 1]) / (nodes[above] - nodes[above - 1])


def _around(nodes: NDArray[np.floating], at: Floats) -> Ends:
    """On a circle."""
    at = (at - nodes[0]) % TURN
    ring = np.append(nodes - nodes[0], TURN)
    below = np.clip(np.searchsorted(ring, at, side="right") - 1, 0, len(nodes) - 1)
    return below, (below + 1) % len(nodes), (at - ring[below]) / (ring[below + 1] - ring[below])


def _merl(merl: Merl, eye: Floats, light: Floats) -> Floats:
    """The cell that a pair of directions lies in, as the authors' own reader takes it; light and eye may change places.

    Rusinkiewicz 1998: the half vector from the normal, the light from the half vector. Theta_h is stored by its square
    root (Matusik et al. 2003), phi_d over half a turn, for turning the material by half a turn changes nothing.
    """
    half = eye + light
    length = np.linalg.norm(half, axis=1, keepdims=True)
    half = np.where(length > 1e-12, half / np.maximum(length, 1e-12), [0.0, 0.0, 1.0])
    theta_h, phi_h = np.arccos(np.clip(half[:, 2], -1, 1)), np.arctan2(half[:, 1], half[:, 0])
    cos, sin = np.cos(-phi_h), np.sin(-phi_h)
    x, y, z = cos * light[:, 0] - sin * light[:, 1], sin * light[:, 0] + cos * light[:, 1], light[:, 2]
    cos, sin = np.cos(-theta_h), np.sin(-theta_h)
    x, z = cos * x + sin * z, cos * z - sin * x
    theta_d, phi_d = np.arccos(np.clip(z, -1, 1)), np.arctan2(y, x) % math.pi
    rows, columns, turns = merl.values.shape[:3]
    right = math.pi / 2
    cell = (
        np.clip((np.sqrt(np.maximum(theta_h, 0) / right) * rows).astype(int), 0, rows - 1),
        np.clip((theta_d / right * columns).astype(int), 0, columns - 1),
        np.clip((phi_d / math.pi * turns).astype(int), 0, turns - 1),
    )
    return np.maximum(np.asarray(merl.values[cell], np.float64), 0)
