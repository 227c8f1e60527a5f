"""Bounces between level ground and a level cloud base by any exchange of half-bounces, with a closed tail."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.clouds.radiosity.maps import Bounced, BounceMaps

Exchange = Callable[[np.ndarray], np.ndarray]
"""Radiosity of one plane, (..., N, N), to the irradiance of the other."""

MOST = 400
"""Half-bounces at most when asked to converge: R rho = 0.97 leaves 5e-6."""


def bounce(
    exchange: Exchange,
    ground_first: np.ndarray,
    cloud_first: np.ndarray,
    albedo: np.ndarray,
    reflectance: np.ndarray,
    half_bounces: int,
    tail: bool = True,
) -> tuple[np.ndarray, np.ndarray]:
    """Sum half-bounces in Jacobi order: both sides from the other's last term, so that each path counts once.

    Belcour 2009, section 5.2.3, with the product by R once (errata 001-20).

    Args:
        exchange: of one half-bounce.
        ground_first, cloud_first: radiosities before any bounce, (C, N, N).
        albedo, reflectance: of ground and cloud base, (C, N, N).
        half_bounces: how many each side receives.
        tail: add what later ones would, as a geometric series of the last two terms' ratio: exact between endless
            uniform planes, where it makes the sum 1 / (1 - R rho) (errata 001-10). From four half-bounces on.

    Returns:
        irradiance added on ground and cloud base, (C, N, N) each.
    """
    from_ground, from_cloud = ground_first, cloud_first
    ground, cloud = np.zeros_like(ground_first), np.zeros_like(cloud_first)
    terms: list[tuple[np.ndarray, np.ndarray]] = []
    dark = np.zeros_like(ground_first)
    # Under a sun above the layer only the ground has first light: its paths reach either side every second half-bounce.
    lit = bool(ground_first.any()), bool(cloud_first.any())
    for _ in range(half_bounces):
        term = exchange(from_cloud) if lit[1] else dark, exchange(from_ground) if lit[0] else dark
        lit = lit[1], lit[0]
        ground, cloud = ground + term[0], cloud + term[1]
        from_ground, from_cloud = (albedo * term[0] if lit[0] else dark), (reflectance * term[1] if lit[1] else dark)
        terms = [*terms[-3:], term]
    if tail and len(terms) == 4:
        ground, cloud = (
            total + series_tail([pair[side] for pair in terms]) for side, total in enumerate((ground, cloud))
        )
    return ground, cloud


def series_tail(terms: list[np.ndarray], axes: tuple[int, ...] = (-2, -1)) -> np.ndarray:
    """What follows four terms of a series that repeats its ratio every second term, summed over `axes` to find it."""
    before, now = terms[0] + terms[1], terms[2] + terms[3]
    sums = before.sum(axes, keepdims=True)
    ratio = now.sum(axes, keepdims=True) / np.where(sums > 0, sums, 1)
    ratio = np.clip(ratio, 0, 0.999)
    return now * ratio / (1 - ratio)


def half_bounces_for(albedo: np.ndarray, reflectance: np.ndarray, tolerance: float) -> int:
    """Half-bounces after which less than `tolerance` of the sum is left: (R rho)^(n + 1), at the brightest cell."""
    product = float(np.max(albedo) * np.max(reflectance))
    if product <= 0:
        return 2
    if product >= 1:
        return MOST
    return int(np.clip(2 * np.ceil(np.log(tolerance) / np.log(product)), 2, MOST))


def bounce_maps(exchange: Exchange, maps: BounceMaps, half_bounces: int, tail: bool = True) -> Bounced:
    """The same of a technique's maps, bands last."""
    ground, cloud = (first(field) for field in maps.leaving())
    found = bounce(exchange, ground, cloud, first(maps.albedo), first(maps.reflectances), half_bounces, tail)
    return Bounced(*(np.moveaxis(field, 0, -1) for field in found))


def first(field: np.ndarray) -> np.ndarray:
    """Bands first, contiguous, in float32."""
    return np.ascontiguousarray(np.moveaxis(field, -1, 0), np.float32)
