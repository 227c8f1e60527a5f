"""Lookup of measured BRDFs in float64: one sum over the corners of a table's cell.

Porquet 2005 looks a table up by five bilinear interpolations, four by the light's angles and one by the eye's; here
the same is one sum over the sixteen corners of a cell, each weighed by the product of its shares. At the zenith all
azimuths are one direction (errata 003-4), by the table's own making.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from renderer.reference.directional_world import Floats, Measured

TURN = 2 * math.pi

Ends = tuple[NDArray[np.signedinteger], NDArray[np.signedinteger], Floats]
"""Nodes before and behind a place, and the share of the latter."""


def reflected(material: Measured, to_eye: Floats, to_light: Floats) -> Floats:
    """BRDF (M, 3) [1/sr] for unit directions (M, 3) along tangent, bitangent and normal; the horizon clamps both."""
    eye, light = _raised(to_eye), _raised(to_light)
    axes = _half(material, eye, light) if material.coordinates == "half" else _angles(material, eye, light)
    found = np.zeros((len(eye), 3))
    for corner in itertools.product((0, 1), repeat=len(axes)):
        weight = math.prod(share if side else 1 - share for side, (_, _, share) in zip(corner, axes, strict=True))
        index = tuple(ends[side] for side, (*ends, _) in zip(corner, axes, strict=True))
        found += np.asarray(weight)[:, None] * material.values[index]
    return found


def _raised(directions: Floats) -> Floats:
    """Directions, those below the horizon moved up onto it."""
    up = directions * [1, 1, 0] + np.maximum(directions * [0, 0, 1], 0)
    length = np.linalg.norm(up, axis=1, keepdims=True)
    # straight down has no azimuth; any will do
    return np.where(length > 1e-12, up / np.maximum(length, 1e-12), [1.0, 0.0, 0.0])


def _angles(material: Measured, eye: Floats, light: Floats) -> list[Ends]:
    """Where a pair of directions lies by their own angles, or by the difference of their azimuths."""
    theta = [np.arccos(np.clip(each[:, 2], 0, 1)) for each in (eye, light)]
    phi = [np.arctan2(each[:, 1], each[:, 0]) for each in (eye, light)]
    first, second, third, fourth = material.nodes
    if material.coordinates == "difference":
        own, other = _between(second, np.zeros(len(eye))), _around(fourth, phi[1] - phi[0], TURN)
    else:
        own, other = _around(second, phi[0], TURN), _around(fourth, phi[1], TURN)
    return [_between(first, theta[0]), own, _between(third, theta[1]), other]


def _half(material: Measured, eye: Floats, light: Floats) -> list[Ends]:
    """Where it lies by the half vector: turned until that is the normal, the light is what is counted (Rusinkiewicz
    1998). Eye and light may change places, and half a turn about it changes nothing."""
    half = eye + light
    length = np.linalg.norm(half, axis=1, keepdims=True)
    half = np.where(length > 1e-12, half / np.maximum(length, 1e-12), [0.0, 0.0, 1.0])
    theta_h, phi_h = np.arccos(np.clip(half[:, 2], -1, 1)), np.arctan2(half[:, 1], half[:, 0])
    cos, sin = np.cos(-phi_h), np.sin(-phi_h)
    x, y, z = cos * light[:, 0] - sin * light[:, 1], sin * light[:, 0] + cos * light[:, 1], light[:, 2]
    cos, sin = np.cos(-theta_h), np.sin(-theta_h)
    x, z = cos * x + sin * z, cos * z - sin * x
    first, second, third, fourth = material.nodes
    return [
        _between(first, np.sqrt(np.maximum(theta_h, 0) / (math.pi / 2))),
        _between(second, np.zeros(len(eye))),
        _between(third, np.arccos(np.clip(z, -1, 1))),
        _around(fourth, np.arctan2(y, x), math.pi),
    ]


def _between(nodes: NDArray[np.floating], at: Floats) -> Ends:
    """On a line: the first node and the last count beyond them."""
    if len(nodes) == 1:
        none = np.zeros(len(at), np.int64)
        return none, none, np.zeros(len(at))
    at = np.clip(at, nodes[0], nodes[-1])
    above = np.clip(np.searchsorted(nodes, at), 1, len(nodes) - 1)
    return above - 1, above, (at - nodes[above - 1]) / (nodes[above] - nodes[above - 1])


def _around(nodes: NDArray[np.floating], at: Floats, period: float) -> Ends:
    """On a circle."""
    at = (at - nodes[0]) % period
    ring = np.append(nodes - nodes[0], period)
    below = np.clip(np.searchsorted(ring, at, side="right") - 1, 0, len(nodes) - 1)
    return below, (below + 1) % len(nodes), (at - ring[below]) / (ring[below + 1] - ring[below])
