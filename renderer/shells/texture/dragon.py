"""The outline of a dragon, as a height: bones with a thickness each, joined smoothly."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

BODY = np.array([  # x, y, radius along the spine, from the tail's tip to the snout
    (0.1, 0.18, 0.008), (0.17, 0.11, 0.016), (0.28, 0.1, 0.026), (0.37, 0.16, 0.036), (0.42, 0.26, 0.05),
    (0.44, 0.37, 0.07), (0.48, 0.48, 0.082), (0.55, 0.57, 0.07), (0.63, 0.63, 0.05), (0.68, 0.71, 0.04),
    (0.68, 0.8, 0.038), (0.73, 0.86, 0.045), (0.8, 0.85, 0.036), (0.87, 0.8, 0.018),
])
LIMBS = [  # chains of x, y, radius: legs, horns, jaw
    np.array([(0.45, 0.36, 0.05), (0.55, 0.28, 0.03), (0.53, 0.17, 0.02), (0.61, 0.13, 0.014)]),
    np.array([(0.44, 0.38, 0.05), (0.33, 0.36, 0.03), (0.29, 0.26, 0.02), (0.22, 0.24, 0.014)]),
    np.array([(0.58, 0.58, 0.04), (0.7, 0.53, 0.024), (0.74, 0.43, 0.017), (0.82, 0.41, 0.012)]),
    np.array([(0.73, 0.88, 0.02), (0.66, 0.93, 0.012), (0.6, 0.94, 0.006)]),
    np.array([(0.79, 0.83, 0.022), (0.84, 0.755, 0.011)]),
]
FINGERS = np.array([(0.12, 0.93), (0.06, 0.76), (0.09, 0.6), (0.2, 0.5)])
"""Tips of the wing's bones."""

WRIST = (0.34, 0.78)
SHOULDER = (0.5, 0.55)


def dragon(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Height in [0, 1] of the figure over the unit square, 0 outside; x and y are broadcast together."""
    x, y = np.broadcast_arrays(np.asarray(x, float), np.asarray(y, float))
    height = _round(x, y, BODY)
    for limb in LIMBS:
        height = np.maximum(height, 0.9 * _round(x, y, limb))
    # Scales: ripples along the spine, where there is a body.
    spine, along = _spine(x, y)
    height = height * (1.0 + 0.1 * np.cos(2 * np.pi * along * 34) * np.clip(1.5 - spine, 0.0, 1.0))
    height = np.maximum(height, _wing(x, y))
    eye = np.hypot(x - 0.755, y - 0.872)
    return np.clip(np.where(eye < 0.012, 0.3, height), 0.0, 1.0)


def _segments(
    x: np.ndarray, y: np.ndarray, chain: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Distance over radius, share along and radius, for each bone of a chain."""
    for (ax, ay, ar), (bx, by, br) in pairwise(chain):
        dx, dy = bx - ax, by - ay
        t = np.clip(((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy), 0.0, 1.0)
        radius = ar + (br - ar) * t
        yield np.hypot(x - ax - t * dx, y - ay - t * dy) / radius, t, radius


def _round(x: np.ndarray, y: np.ndarray, chain: np.ndarray) -> np.ndarray:
    """Height of a chain of bones of round section, 1 over a radius of 0.08."""
    height = np.zeros(x.shape)
    for off, _, radius in _segments(x, y, chain):
        dome = np.sqrt(np.clip(1.0 - off * off, 0.0, 1.0))
        height = np.maximum(height, dome * (0.3 + 0.6 * np.minimum(radius / 0.08, 1.0)))
    return height


def _spine(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance from the spine over the body's radius there, and the length along it in units of the square."""
    best, along, start = np.full(x.shape, np.inf), np.zeros(x.shape), 0.0
    for (off, t, _), a, b in zip(_segments(x, y, BODY), BODY[:-1], BODY[1:]):
        length = float(np.hypot(*(b - a)[:2]))
        nearer = off < best
        best, along = np.where(nearer, off, best), np.where(nearer, start + t * length, along)
        start += length
    return best, along


def _wing(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Height of the wing: thin skin that hangs between bones."""
    height = _round(x, y, np.array([(*SHOULDER, 0.034), (*WRIST, 0.022)]))
    for tip in FINGERS:
        height = np.maximum(height, 0.8 * _round(x, y, np.array([(*WRIST, 0.02), (*tip, 0.007)])))
    skin = np.zeros(x.shape)
    ends = [*map(tuple, FINGERS), SHOULDER]
    for first, second in pairwise(ends):
        inside, edge = _within(x, y, WRIST, first, second)
        skin = np.maximum(skin, np.where(inside, 0.12 + 0.14 * np.clip(edge, 0.0, 1.0), 0.0))
    return np.maximum(height, skin)


def _within(x: np.ndarray, y: np.ndarray, a, b, c) -> tuple[np.ndarray, np.ndarray]:
    """Whether points lie in a triangle whose side b-c is cut out in an arc, and their share of a in it."""
    area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
    second = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area
    third = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area
    first = 1.0 - second - third
    arc = 0.9 * second * third / np.maximum(second + third, 1e-9) ** 2
    return (second >= 0) & (third >= 0) & (first >= arc), first
