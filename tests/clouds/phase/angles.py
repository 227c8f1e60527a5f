"""Cosines at which phase functions are held against their twins."""

from __future__ import annotations

import numpy as np

ANGLES = np.radians(np.concatenate([np.linspace(0, 8, 300), np.linspace(8, 172, 300), np.linspace(172, 180, 300)]))
# As the shader receives them, so that a rounded cosine is no error of the function.
COSINES = np.cos(ANGLES).astype(np.float32).astype(np.float64)


def integral(values: np.ndarray, cosines: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Integral over the sphere of a function given at Gauss-Legendre nodes (N, bands)."""
    return 2 * np.pi * weights @ values
