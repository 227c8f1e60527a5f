"""Published reflectances in closed form: what built-in tables sample, and what a table's error is measured against.

Directions are unit vectors (..., 3) in the surface's frame, above the horizon; a reflectance is in sr-1. Each is
reciprocal.
"""

from __future__ import annotations

import math

import numpy as np


def _cosines(view: np.ndarray, light: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Cosines of view and light to the normal, the unit half vector, and its cosine with the view."""
    half = view + light
    half = half / np.maximum(np.linalg.norm(half, axis=-1, keepdims=True), 1e-12)
    level = 1e-6
    return (
        np.maximum(view[..., 2], level),
        np.maximum(light[..., 2], level),
        half,
        np.maximum((half * view).sum(axis=-1), level),
    )


def oren_nayar(view: np.ndarray, light: np.ndarray, roughness: float) -> np.ndarray:
    """Matt matter of Lambertian facets, (...): Oren & Nayar 1994, equation 30, for a reflectance of 1.

    Where both directions are level the equation has no bound; here it stays at what it is 5 degrees above.

    Args:
        roughness: standard deviation of the facets' slope angle [rad].
    """
    square = roughness * roughness
    a, b = 1 - 0.5 * square / (square + 0.33), 0.45 * square / (square + 0.09)
    along = view[..., 0] * light[..., 0] + view[..., 1] * light[..., 1]
    greater = np.maximum(np.maximum(view[..., 2], light[..., 2]), math.sin(math.radians(5.0)))
    # cos(phi difference) sin(alpha) tan(beta), where alpha is the greater angle and beta the smaller
    relief = np.maximum(along, 0) / greater
    return np.asarray((a + b * relief) / math.pi)


def ashikhmin_shirley(
    view: np.ndarray, light: np.ndarray, diffuse: np.ndarray, specular: np.ndarray, along: float, across: float
) -> np.ndarray:
    """Brushed or woven matter with a grain, (..., 3): Ashikhmin & Shirley 2000, equations 4 and 5.

    Args:
        diffuse, specular: reflectances (3,). along, across: exponents of the lobe along the tangent and the bitangent.
    """
    cos_view, cos_light, half, facing = _cosines(view, light)
    level = np.maximum(1 - half[..., 2] ** 2, 1e-12)
    exponent = (along * half[..., 0] ** 2 + across * half[..., 1] ** 2) / level
    lobe = math.sqrt((along + 1) * (across + 1)) / (8 * math.pi) * np.maximum(half[..., 2], 1e-6) ** exponent
    lobe = lobe / (facing * np.maximum(cos_view, cos_light))
    fresnel = specular + (1 - specular) * ((1 - facing) ** 5)[..., None]
    below = 28 / (23 * math.pi) * diffuse * (1 - specular)
    soft = (1 - (1 - cos_view / 2) ** 5) * (1 - (1 - cos_light / 2) ** 5)
    return np.asarray(lobe[..., None] * fresnel + below * soft[..., None])


def metal(view: np.ndarray, light: np.ndarray, colour: np.ndarray, roughness: float) -> np.ndarray:
    """Rough metal, (..., 3); see `metal_of`."""
    cos_view, cos_light, half, facing = _cosines(view, light)
    return metal_of(cos_view, cos_light, half[..., 2], facing, colour, roughness)


def metal_of(
    cos_view: np.ndarray,
    cos_light: np.ndarray,
    cos_half: np.ndarray,
    facing: np.ndarray,
    colour: np.ndarray,
    roughness: float,
) -> np.ndarray:
    """Rough metal, (..., 3): Walter et al. 2007, equations 20, 33 and 34 (GGX), with Schlick's 1994 Fresnel term.

    Args:
        cos_view, cos_light, cos_half: to the normal. facing: of the half vector with the view. colour: reflectance (3,)
            at normal incidence. roughness: alpha of GGX.
    """
    square = roughness * roughness
    spread = square / (math.pi * (cos_half**2 * (square - 1) + 1) ** 2)
    masks = [2 / (1 + np.sqrt(1 + square * (1 / c**2 - 1))) for c in (cos_view, cos_light)]
    fresnel = colour + (1 - colour) * ((1 - facing) ** 5)[..., None]
    return np.asarray((spread * masks[0] * masks[1] / (4 * cos_view * cos_light))[..., None] * fresnel)


def phong(view: np.ndarray, light: np.ndarray, diffuse: np.ndarray, specular: float, shininess: float) -> np.ndarray:
    """The normalised Phong lobe, (..., 3): Lafortune & Willems 1994, equations 4 and 5.

    Args:
        diffuse: reflectance (3,). specular: share of the lobe. shininess: its exponent.
    """
    mirrored = light * [-1, -1, 1]
    lobe = np.maximum((mirrored * view).sum(axis=-1), 0) ** shininess * (specular * (shininess + 2) / (2 * math.pi))
    return np.asarray(diffuse / math.pi + lobe[..., None])


def lafortune(
    view: np.ndarray, light: np.ndarray, diffuse: np.ndarray, colour: np.ndarray, cxy: float, cz: float, exponent: float
) -> np.ndarray:
    """A generalised cosine lobe, (..., 3): Lafortune et al. 1997, equation 8, isotropic (formulas f).

    Args:
        diffuse: reflectance (3,). colour: of the lobe (3,) [sr-1]. cxy, cz: its two coefficients.
    """
    dot = cxy * (view[..., 0] * light[..., 0] + view[..., 1] * light[..., 1]) + cz * view[..., 2] * light[..., 2]
    return np.asarray(diffuse / math.pi + (np.maximum(dot, 0) ** exponent)[..., None] * colour)
