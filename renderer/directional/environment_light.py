"""Light of all directions, precomputed: its irradiance as spherical harmonics, and its reflection in rough surfaces.

Irradiance is radiance convolved with a clamped cosine, of which bands 0, 1, 2 and 4 matter and band 3 is nothing
(Ramamoorthi & Hanrahan 2001, equations 8 and 19): bands to 2 are theirs; the fourth takes errors down by two to four.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

import numpy as np

from renderer.directional.environment_pictures import ROWS, directions, fewer, solid_angles
from renderer.world.sky import SkyNow
from renderer.world.sky_picture import VIEW_SHAPE

BANDS = (0, 1, 1, 1, 2, 2, 2, 2, 2, 4, 4, 4, 4, 4, 4, 4, 4, 4)

COSINE = {0: math.pi, 1: 2 * math.pi / 3, 2: math.pi / 4, 4: -math.pi / 24}
"""What each band of radiance is multiplied by (Ramamoorthi & Hanrahan 2001, equation 8)."""

SHARPEST = float(round((ROWS / math.pi) ** 2))
"""Exponent of the lobe that is as narrow as a texel of the picture itself; each smoother level has a quarter of it."""

SMOOTHEST_ROWS = 8


def polynomials(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Real spherical harmonics of bands 0, 1, 2 and 4, (18, ...), without their factors; twin of the shader's."""
    xx, yy, zz = x * x, y * y, z * z
    one = np.ones_like(x)
    return np.stack([
        one, y, z, x,
        x * y, y * z, 3 * zz - 1, x * z, xx - yy,
        x * y * (xx - yy), y * z * (3 * xx - yy), x * y * (7 * zz - 1), y * z * (7 * zz - 3),
        35 * zz * zz - 30 * zz + 3,
        x * z * (7 * zz - 3), (xx - yy) * (7 * zz - 1), x * z * (xx - 3 * yy), xx * (xx - 3 * yy) - yy * (3 * xx - yy),
    ])  # fmt: skip


@functools.cache
def _squares() -> np.ndarray:
    """Integrals of the polynomials' squares over the sphere, (18,)."""
    x, w = np.polynomial.legendre.leggauss(8)
    turn = np.arange(16) * (math.pi / 8)
    level = np.sqrt(1 - x * x)[:, None]
    basis = polynomials(level * np.cos(turn), level * np.sin(turn), np.broadcast_to(x[:, None], (8, 16)))
    return np.asarray(np.einsum("kij,i->k", basis**2, w) * (math.pi / 8))


def _weights(basis: np.ndarray, solid: np.ndarray) -> np.ndarray:
    """What radiance at places of a solid angle adds to each coefficient of the irradiance, in the shape of `basis`."""
    factors = np.array([COSINE[band] for band in BANDS]) / _squares()
    return np.asarray(basis * solid * factors.reshape(-1, *(1,) * (basis.ndim - 1)))


def harmonics_of(image: np.ndarray) -> np.ndarray:
    """Coefficients (18, 3) of the irradiance under a picture: E(n) is their sum with `polynomials`."""
    x, y, z = np.moveaxis(directions(*image.shape[:2]), -1, 0)
    weights = _weights(polynomials(x, y, z), solid_angles(*image.shape[:2]))
    return np.asarray(np.einsum("kij,ijc->kc", weights, image))


def irradiance(harmonics: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Irradiance (N, 3) of planes that face normals (N, 3)."""
    return np.asarray(polynomials(*np.moveaxis(normals, -1, 0)).T @ harmonics)


@functools.cache
def _sky_weights() -> np.ndarray:
    """What each value of the sky's picture adds, (18, values): the sun stands in the north.

    The picture is read as `renderer.world.sky.sky_radiance` reads it, at the middles of small cells of one solid angle.
    """
    rows, columns = VIEW_SHAPE
    z = ((np.arange(256) + 0.5) / 128 - 1)[:, None]
    azimuth = ((np.arange(256) + 0.5) / 128 * math.pi - math.pi)[None]
    level = np.sqrt(1 - z * z)
    basis = polynomials(*np.broadcast_arrays(level * np.sin(azimuth), level * np.cos(azimuth), z))
    weights = _weights(basis, np.full(basis.shape[1:], 4 * math.pi / 256**2)).reshape(18, -1)
    down = np.sqrt(np.arcsin(np.clip(z, 0, 1)) / (0.5 * math.pi)) * (rows - 1)
    across = np.sqrt(np.abs(azimuth) / math.pi) * (columns - 1)
    found = np.zeros((18, rows * columns))
    (i, v), (j, u) = ((np.minimum(at.astype(int), count - 2), at) for at, count in ((down, rows), (across, columns)))
    for one, other in ((0, 0), (0, 1), (1, 0), (1, 1)):
        share = np.abs(1 - one - (v - i)) * np.abs(1 - other - (u - j))
        place = np.broadcast_to((i + one) * columns + j + other, share.shape).ravel()
        for row, weight in zip(found, weights):
            row += np.bincount(place, weight * share.ravel(), rows * columns)
    return found


def sky_harmonics(now: SkyNow) -> np.ndarray:
    """Coefficients (18, 3) of the irradiance under the sky, of a frame with the sun in the north."""
    return np.asarray(_sky_weights() @ now.view.reshape(-1, 3).astype(np.float64))


def smoothed(image: np.ndarray, tell: Callable[[float], None]) -> list[np.ndarray]:
    """Smoother pictures, each half the size of the one before: what rough mirrors see.

    The first is the mean of four texels. Each further one is radiance convolved with a normalised cosine lobe of the
    exponent SHARPEST / 4^k (as prefiltered environment maps are: Kautz & McCool 2000), summed over texels of its size.
    """
    levels = [fewer(image, image.shape[0] // 2)]
    while len(levels[-1]) > SMOOTHEST_ROWS:
        rows = len(levels[-1]) // 2
        tell(len(levels) / math.log2(ROWS / SMOOTHEST_ROWS))
        levels.append(_through_lobe(fewer(image, rows), SHARPEST / 4 ** (len(levels) + 1)))
    return levels


def _through_lobe(image: np.ndarray, exponent: float) -> np.ndarray:
    """Radiance seen by cosine lobes about the directions of a picture's own texels."""
    at = directions(*image.shape[:2]).reshape(-1, 3).astype(np.float32)
    solid = solid_angles(*image.shape[:2]).reshape(-1, 1)
    light = np.concatenate([image.reshape(-1, 3) * solid, solid], axis=1).astype(np.float32)
    parts = []
    for some in np.array_split(at, max(len(at) // 512, 1)):
        cosine = np.maximum(some @ at.T, np.float32(1e-12))
        parts.append(np.exp(np.maximum(np.log(cosine) * np.float32(exponent), np.float32(-60))) @ light)
    sums = np.concatenate(parts)
    return np.asarray((sums[:, :3] / sums[:, 3:]).reshape(image.shape), np.float64)


def level_of(shininess: float) -> float:
    """Level of the pictures on which a lobe of that exponent lies."""
    return 0.5 * math.log2(SHARPEST / shininess)
