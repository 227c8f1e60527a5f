"""Leaves as SGGX microflakes: a symmetric matrix a voxel, which filters linearly (Heitz, Dupuy, Crassin & Dachsbacher
2015)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.core.technique import Arrays
from renderer.forest.lobe_levels import averaged, mean_normals
from renderer.forest.pattern_mips import LEVELS

Floats = NDArray[np.floating]

FLATTEST = 0.06
"""Least area that flakes show edge on: the matrix of flat ones alone has no inverse."""

POINTS = 12
"""Visible flakes that stand for all: points of a golden spiral on the disk."""


def disk(points: int = POINTS) -> tuple[Floats, Floats, Floats]:
    """Points spread evenly over the unit disk, and the hemisphere's height above them."""
    n = np.arange(points)
    radius, turn = np.sqrt((n + 0.5) / points), n * 2.399963229728653
    return radius * np.cos(turn), radius * np.sin(turn), np.sqrt(1 - radius**2)


def matrices(way: Floats, kappa: Floats) -> Floats:
    """Upper triangles (.., 6) xx, yy, zz, xy, xz, yz of flakes that show what the leaves do along and across `way`.

    A share kappa of the leaves lies across `way`, the others face everywhere: they show (1 + kappa) / 2 along it and
    (1 - kappa) / 2 across; SGGX has sigma(v)^2 = v S v (equation 6).
    """
    along = ((1 + kappa) / 2) ** 2
    across = np.maximum((1 - kappa) / 2, FLATTEST) ** 2
    x, y, z = np.moveaxis(way, -1, 0)
    outer = np.stack([x * x, y * y, z * z, x * y, x * z, y * z], axis=-1)
    even = np.array([1, 1, 1, 0, 0, 0], np.float32)
    return across[..., None] * even + (along - across)[..., None] * outer


def encode(matrix: Floats) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Bytes of the roots of the diagonal, and of the correlations (section 4.5): (.., 4) each, the last one idle."""
    root = np.sqrt(np.maximum(matrix[..., :3], 1e-8))
    x, y, z = np.moveaxis(root, -1, 0)
    lean = matrix[..., 3:] / np.stack([x * y, x * z, y * z], axis=-1)
    idle = np.zeros((*root.shape[:-1], 1))
    spread = np.concatenate([root, idle], axis=-1)
    leaning = np.concatenate([np.clip(lean, -1, 1) * 0.5 + 0.5, idle], axis=-1)
    return np.rint(np.clip(spread, 0, 1) * 255).astype(np.uint8), np.rint(leaning * 255).astype(np.uint8)


def decode(spread: NDArray[np.uint8], lean: NDArray[np.uint8]) -> Floats:
    """Upper triangles (.., 6) of bytes."""
    root = np.maximum(spread[..., :3] / 255.0, 0.01)
    x, y, z = np.moveaxis(root, -1, 0)
    # Flat flakes lean all the way: what rounding adds would leave them no area at all.
    r = np.clip(lean[..., :3] / 127.5 - 1, -0.995, 0.995)
    return np.concatenate([root**2, r * np.stack([x * y, x * z, y * z], axis=-1)], axis=-1)


def _across(v: Floats) -> tuple[Floats, Floats]:
    """Two unit vectors across v (.., 3) and each other. Source: Duff et al. 2017, JCGT 6(1)."""
    sign = np.where(v[..., 2] < 0, -1.0, 1.0)
    a = -1 / (sign + v[..., 2])
    b = v[..., 0] * v[..., 1] * a
    return (
        np.stack([1 + sign * v[..., 0] ** 2 * a, sign * b, -sign * v[..., 0]], axis=-1),
        np.stack([b, sign + v[..., 1] ** 2 * a, -v[..., 1]], axis=-1),
    )


def visible(matrix: Floats, eye: Floats, points: int = POINTS) -> Floats:
    """Normals (.., points, 3) of flakes as an eye (.., 3) sees them: all count alike.

    Source: Heitz et al. 2015, equations 20 to 23 (the ellipsoid's own sphere, seen along the eye).
    """
    xx, yy, zz, xy, xz, yz = np.moveaxis(matrix, -1, 0)
    full = np.stack([np.stack([xx, xy, xz], -1), np.stack([xy, yy, yz], -1), np.stack([xz, yz, zz], -1)], -2)
    k, j = _across(eye)

    def form(a: Floats, b: Floats) -> Floats:
        result: Floats = np.einsum("...a,...ab,...b->...", a, full, b)
        return result

    kj, ki, ji, jj, ii = form(k, j), form(k, eye), form(j, eye), form(j, j), form(eye, eye)
    area = np.sqrt(np.maximum(jj * ii - ji * ji, 1e-10))
    volume = np.sqrt(np.maximum(np.linalg.det(full), 1e-12))
    inverse = 1 / np.sqrt(np.maximum(ii, 1e-10))
    u, v, w = disk(points)
    shape = (..., None)
    on_k = u * (volume / area)[shape] + v * (-inverse * (ki * ji - kj * ii) / area)[shape] + w * (inverse * ki)[shape]
    on_j = v * (inverse * area)[shape] + w * (inverse * ji)[shape]
    on_i = w * (inverse * ii)[shape]
    normal = on_k[..., None] * k[..., None, :] + on_j[..., None] * j[..., None, :] + on_i[..., None] * eye[..., None, :]
    result: Floats = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
    return result


def reflected(matrix: Floats, eyes: Floats, suns: Floats, points: int = POINTS) -> Floats:
    """What flakes of matrices (n, 6) reflect towards eyes (V, 3) from suns (S, 3), times pi over the albedo: (n, V, S).

    Diffuse flakes (section 5.3): the mean of max(m.s, 0) over the flakes m that are seen.
    """
    given = np.broadcast_to(matrix[:, None], (len(matrix), len(eyes), 6))
    seen = visible(given, np.broadcast_to(eyes, (len(matrix), *eyes.shape)), points)
    result: Floats = np.maximum(seen @ suns.T, 0).mean(axis=2)
    return result


def bake_sggx(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]) -> Arrays:
    """Matrices of every level, coarser ones the children's mean, weighted by opacity.

    Args:
        arguments: none. inputs: `pattern`.

    Returns:
        `spread`, `lean` and the same with `_1` to `_5`, uint8 [k, j, i, 4]: see `encode`.
    """
    pattern = inputs["pattern"]
    progress(0.0, "giving leaves their flakes")
    matrix = matrices(*mean_normals(pattern["normal"])).astype(np.float32)
    result = dict(zip(("spread", "lean"), encode(matrix), strict=True))
    opacity = pattern["colour"][..., 3].astype(np.float32) / np.float32(255)
    for level in [n for n in range(1, LEVELS + 1) if f"colour_{n}" in pattern]:
        progress(level / (LEVELS + 1), "averaging flakes")
        matrix = averaged(matrix, opacity)
        opacity = pattern[f"colour_{level}"][..., 3].astype(np.float32) / np.float32(255)
        result |= dict(zip((f"spread_{level}", f"lean_{level}"), encode(matrix), strict=True))
    return result
