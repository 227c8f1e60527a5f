"""Rays and shells for the geometry's tests, and the truth by long doubles."""

from __future__ import annotations

import numpy as np

RADIUS, BASE, TOP = 6.35e6, 2500.0, 2600.0
WHERE = (2.0, 1000.0, 2550.0, 4000.0, 1e4, 1e5, 4e5, 2e6, 2e7)
"""Altitudes of cameras: on the ground, below, inside and above the layer, in orbit and beyond, m."""

DECLARED = "uniform float planet_radius;"


def rays(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Origins (N, 3) [m] and directions (N, 3), float32: half of each camera's rays graze the layer."""
    rng = np.random.Generator(np.random.PCG64(17))
    origins, directions = [], []
    for altitude in WHERE:
        n = count // len(WHERE) + 1
        if altitude > 5e4:
            lowest = RADIUS + rng.uniform(-2e4, 4e3, n)  # how near to the centre the ray's line comes
            lowest[::4] = rng.uniform(0, RADIUS, len(lowest[::4]))
            off = np.arcsin(lowest / (RADIUS + altitude))
            turn = rng.uniform(0, 2 * np.pi, n)
            ray = np.stack([np.sin(off) * np.cos(turn), np.sin(off) * np.sin(turn), -np.cos(off)], axis=-1)
            frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
            origin = np.tile(frame @ [0, 0, RADIUS + altitude], (n, 1)) - [0, 0, RADIUS]
            ray = ray @ frame.T
        else:
            ray = rng.normal(size=(n, 3))
            ray[: n // 2, 2] *= 0.02
            ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
            origin = np.concatenate([rng.uniform(-3e4, 3e4, (n, 2)), np.full((n, 1), altitude)], axis=-1)
        origins.append(origin)
        directions.append(ray)
    return (np.concatenate(origins)[:count].astype(np.float32), np.concatenate(directions)[:count].astype(np.float32))


def legs(origins: np.ndarray, directions: np.ndarray, moved: float = 0.0) -> np.ndarray:
    """Lengths of the stretches before and behind the point nearest the centre, (N, 2) [m], by intersection with both
    spheres in long doubles; `moved`: metres added to both radii."""
    o = origins.astype(np.longdouble) + np.array([0, 0, RADIUS], np.longdouble)
    w = directions.astype(np.longdouble)
    w = w / np.sqrt((w * w).sum(axis=-1, keepdims=True))
    along = (o * w).sum(axis=-1)
    outside = (o * o).sum(axis=-1) - along**2

    def half(altitude: float) -> np.ndarray:
        return np.sqrt(np.maximum((np.longdouble(RADIUS) + altitude + moved) ** 2 - outside, 0))

    outer, inner = half(TOP), half(BASE)
    before = np.maximum(-inner, along) - np.maximum(-outer, along)
    behind = np.maximum(outer, along) - np.maximum(inner, along)
    return np.stack([before, behind], axis=-1).astype(np.float64)


def wrong(found: np.ndarray, origins: np.ndarray, directions: np.ndarray) -> int:
    """How many stretches are neither within a thousandth of the truth nor among what both radii moved by 2 m give."""
    exact = legs(origins, directions)
    moved = np.stack([exact, legs(origins, directions, -2.0), legs(origins, directions, 2.0)])
    near = np.abs(found - exact) <= 1e-3 * exact
    inside = (found >= moved.min(axis=0) * (1 - 1e-6)) & (found <= moved.max(axis=0) * (1 + 1e-6))
    return int(np.count_nonzero(~(near | inside)))
