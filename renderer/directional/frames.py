"""A frame about each normal, and normals as the GPU keeps them.

Porquet 2005 builds the frame by turning one angle of the normal, which is square only by one reading of his angles
(errata 003-3) and has poles; Duff et al. 2017 (JCGT 6, 1) have neither.
"""

from __future__ import annotations

import numpy as np

CODES = 65535
"""Steps of an octahedral coordinate."""


def frames(normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Tangents and bitangents (N, 3) of unit normals (N, 3): with them a right-handed frame.

    Duff et al. 2017, listing 3.
    """
    x, y, z = np.moveaxis(np.asarray(normals), -1, 0)
    sign = np.where(z >= 0, 1.0, -1.0).astype(x.dtype)
    a = -1 / (sign + z)
    b = x * y * a
    return (
        np.stack([1 + sign * x * x * a, sign * b, -sign * x], axis=-1),
        np.stack([b, sign + y * y * a, -y], axis=-1),
    )


def encoded(normals: np.ndarray) -> np.ndarray:
    """Octahedral codes (N,) uint32 of unit normals (N, 3): 16 bits of x, 16 of y above them."""
    flat = normals / np.abs(normals).sum(axis=-1, keepdims=True)
    folded = (1 - np.abs(flat[..., 1::-1])) * np.where(flat[..., :2] >= 0, 1.0, -1.0)
    plane = np.where(flat[..., 2:] >= 0, flat[..., :2], folded)
    codes = np.rint((plane * 0.5 + 0.5) * CODES).astype(np.uint32)
    return np.asarray(codes[..., 0] | codes[..., 1] << np.uint32(16))


def decoded(codes: np.ndarray) -> np.ndarray:
    """Unit normals (N, 3) float64 of octahedral codes (N,)."""
    plane = np.stack([codes & np.uint32(0xFFFF), codes >> np.uint32(16)], axis=-1) / CODES * 2 - 1
    z = 1 - np.abs(plane).sum(axis=-1, keepdims=True)
    folded = (1 - np.abs(plane[..., ::-1])) * np.where(plane >= 0, 1.0, -1.0)
    normals = np.concatenate([np.where(z >= 0, plane, folded), z], axis=-1)
    return np.asarray(normals / np.linalg.norm(normals, axis=-1, keepdims=True))


def quantised(normals: np.ndarray) -> np.ndarray:
    """Unit normals (N, 3) as the GPU will have them."""
    return decoded(encoded(normals))
