"""Thin leaves as the forest reference has them: what they make of light, and which of them a random number picks."""

from __future__ import annotations

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True)
def uniform(seed: int, pixel: int, stratum: int) -> float:
    """A number in [0, 1) that depends on nothing but its arguments: splitmix64 (Steele, Lea and Flood 2014)."""
    z = np.uint64(seed) * np.uint64(0x9E3779B97F4A7C15) + np.uint64(pixel)
    for word in (np.uint64(0), np.uint64(stratum)):
        z = (z + word + np.uint64(0x9E3779B97F4A7C15)) & np.uint64(0xFFFFFFFFFFFFFFFF)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        z = z ^ (z >> np.uint64(31))
    return float(z >> np.uint64(11)) * 2.0**-53


@njit(cache=True, nogil=True)
def leaves(normal, to_eye, sun):
    """What a voxel's leaves make of light, by its share of the reflected and of the transmitted.

    Thin sheets, each side of which reflects and passes on light as Lambert's paper does (Ross 1981; Shultis and Myneni
    1988). A share kappa of them lies across the mean normal, the others face everywhere alike, so that the mean of all
    normals is the given one; each counts by the area that it shows to the eye.

    Args:
        normal: mean of the leaves' unit normals, kappa long. to_eye, sun: unit vectors.

    Returns:
        Factors of reflectance and of transmittance for the sun, radiance per irradiance across its beam, 1/sr; and by
        how much the sides that are seen face the zenith, -1 to 1.
    """
    kappa = math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    scale = 1.0 / kappa if kappa > 0.0 else 0.0
    kappa = min(kappa, 1.0)
    lit = (normal[0] * sun[0] + normal[1] * sun[1] + normal[2] * sun[2]) * scale
    seen = (normal[0] * to_eye[0] + normal[1] * to_eye[1] + normal[2] * to_eye[2]) * scale
    cosine = min(max(sun[0] * to_eye[0] + sun[1] * to_eye[1] + sun[2] * to_eye[2], -1.0), 1.0)
    between = math.acos(cosine)
    # of leaves facing everywhere, the mean of |m.v||m.s| over those that eye and sun see from one side, and from two
    one_side = (math.sin(between) + (math.pi - between) * cosine) / (3.0 * math.pi)
    two_sides = (math.sin(between) - between * cosine) / (3.0 * math.pi)
    shown = max(kappa * abs(seen) + 0.5 * (1.0 - kappa), 1e-9)
    reflected, passed = (1.0 - kappa) * one_side, (1.0 - kappa) * two_sides
    if lit * seen > 0.0:
        reflected += kappa * lit * seen
    else:
        passed -= kappa * lit * seen
    # over all directions the mean of (m.v) m is v / 3
    upwards = (kappa * seen * normal[2] * scale + (1.0 - kappa) * to_eye[2] / 3.0) / shown
    return reflected / (math.pi * shown), passed / (math.pi * shown), upwards


@njit(cache=True, nogil=True)
def is_wood(scene, tu, tv, tk):
    """Whether the nearest voxel is trunk or branch, through which no light passes."""
    size, layers = scene.anchor.shape[2], scene.anchor.shape[0]
    k = min(max(math.floor(tk + 0.5), 0), layers - 1)
    return scene.anchor[k, math.floor(tv + 0.5) % size, math.floor(tu + 0.5) % size, 3] > 127


@njit(cache=True, nogil=True)
def pick(light, column, n, target, e, passed):
    """The step on which a running sum of one column passes a target, and the sum up to it, from step e on.

    Args:
        light: (n or more, M), with the summands in `column`. e, passed: where the last, smaller target was passed.
    """
    while passed <= target and e < n - 1:
        e += 1
        passed += light[e, column]
    while light[e, column] <= 0.0 and e > 0:
        # rounding can leave the last target beyond the sum, on a step that gives no light
        e -= 1
    return e, passed
