"""Gradient noise that repeats in u and v.

Perlin 2002, "Improving noise": gradients at the nodes of a lattice, blended by 6 t^5 - 15 t^4 + 10 t^3. The gradients
are drawn for a lattice of the period instead of hashed, so that the repetition is exact.
"""

from __future__ import annotations

import numba
import numpy as np

SCALE = np.float32(1.6)
"""Brings the noise's values to about [-1, 1]: a standard deviation of some 0.4."""


def noise(
    rng: np.random.Generator, x: np.ndarray, y: np.ndarray, z: np.ndarray, side: float, cells: int, octaves: int = 1,
    stretch: tuple[float, float] = (1.0, 1.0),
) -> np.ndarray:
    """Sum of octaves, each of twice the frequency and half the amplitude of the last; about [-1, 1], float32.

    Args:
        x, y, z: points, broadcast together, in units of which `side` make a period of x and y; z has none.
        cells: of the lattice along a period of x and y, in the first octave.
        stretch: factors on the cells' number along y and on the frequency along z.
    """
    shape = np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(z))
    total = np.zeros(shape, np.float32)
    for octave in range(octaves):
        along, across = cells << octave, max(1, round(cells * stretch[0])) << octave
        scale = np.array([along / side, across / side, along / side * stretch[1]], np.float32)
        levels = int(np.ceil(max(float(np.max(z)) - float(np.min(z)), 0.0) * scale[2])) + 2
        gradient = rng.standard_normal((levels, across, along, 3)).astype(np.float32)
        gradient /= np.sqrt((gradient**2).sum(axis=-1, keepdims=True))
        px, py, pz = [np.ascontiguousarray(np.broadcast_to(part, shape), np.float32).ravel()
                      for part in (x, y, z - np.float32(np.min(z)))]
        _add(px, py, pz, scale, gradient, np.float32(SCALE * 0.5**octave), total.reshape(-1))
    return total


@numba.njit(cache=True)
def _add(x, y, z, scale, gradient, amplitude, total):
    levels, across, along, _ = gradient.shape
    weight = np.empty((2, 3), np.float32)
    for n in range(len(x)):
        px, py, pz = x[n] * scale[0], y[n] * scale[1], z[n] * scale[2]
        i, j, k = int(np.floor(px)), int(np.floor(py)), int(np.floor(pz))
        fx, fy, fz = px - i, py - j, pz - k
        for axis in range(3):
            t = fx if axis == 0 else (fy if axis == 1 else fz)
            s = t * t * t * (t * (t * np.float32(6) - np.float32(15)) + np.float32(10))
            weight[0, axis], weight[1, axis] = np.float32(1) - s, s
        value = np.float32(0)
        for c in range(2):
            for b in range(2):
                for a in range(2):
                    g = gradient[min(k + c, levels - 1), (j + b) % across, (i + a) % along]
                    dot = g[0] * (fx - a) + g[1] * (fy - b) + g[2] * (fz - c)
                    value += weight[a, 0] * weight[b, 1] * weight[c, 2] * dot
        total[n] += amplitude * value
