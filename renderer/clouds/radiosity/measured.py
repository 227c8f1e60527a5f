"""Two planes cut to discs, bounce by bounce, as any of the techniques computes them: what `measure radiosity` gives."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from renderer.clouds.radiosity.flat import Exchange
from renderer.clouds.radiosity.form_factors import LEVELS, Reading
from renderer.clouds.radiosity.kernel import FlatExchange
from renderer.clouds.radiosity.levels import ThreeLevelExchange
from renderer.clouds.radiosity.two_planes import TwoPlanes, solve

CELL = 0.25
"""Side of a cell of the techniques that work on a grid, in heights of the cloud base."""

SAMPLES = 161
"""Radii at which sums are given, evenly from the axis to the rim: those of the reference values."""

FINE = 8
"""Samples along a side of a cell, for the share of it that lies inside the disc."""


def radii(radius: float) -> np.ndarray:
    """Distances from the axis where sums are given, in heights."""
    return np.linspace(0, radius, SAMPLES)


def grid_size(radius: float) -> int:
    """Cells along the side of a grid that holds a disc with some rim and can be cut into the coarsest texels."""
    coarsest = round(LEVELS[-1] / CELL)
    return 2 * coarsest * int(np.ceil((radius + 1) / CELL / coarsest))


def exchange_of(technique: str, radius: float, reading: Reading = "taps") -> Exchange:
    """The half-bounce of a technique on the grid of a disc."""
    n = grid_size(radius)
    return FlatExchange(n, CELL, 1.0) if technique == "fft" else ThreeLevelExchange(n, CELL, 1.0, reading)


def coverage(radius: float) -> np.ndarray:
    """Share of each cell of the grid that lies inside the disc, (N, N)."""
    n = grid_size(radius)
    places = ((np.arange(n * FINE) + 0.5) / FINE - n / 2) * CELL
    inside = places[:, None] ** 2 + places[None, :] ** 2 <= radius * radius
    return inside.reshape(n, FINE, n, FINE).mean(axis=(1, 3))


def on_grid(exchange: Exchange, ground: float, cloud: float, radius: float, bounces: int) -> TwoPlanes:
    """The bounces of two planes cut to a disc, on a grid; the cloud starts with radiosity 1, the ground with 0.

    Args:
        exchange: of one half-bounce on the disc's grid. ground, cloud: albedo of either. radius: in heights.

    Returns:
        the sums along the four axes' mean, between cells' middles linearly.
    """
    inside = coverage(radius)
    # Sums are those of the whole planes, so that what covers a part of a cell is not diluted by the rest of it.
    leaving, total_ground, total_cloud = inside, np.zeros_like(inside), np.ones_like(inside)
    found = []
    for _ in range(bounces):
        from_cloud = ground * exchange(leaving)
        from_ground = cloud * exchange(inside * from_cloud)
        total_ground, total_cloud = total_ground + from_cloud, total_cloud + from_ground
        leaving = inside * from_ground
        found.append((profile(total_ground, radius), profile(total_cloud, radius)))
    ratio = ground * cloud
    powers = np.cumsum(ratio ** np.arange(bounces + 1))
    sums = np.array([pair[0] for pair in found]), np.array([pair[1] for pair in found])
    return TwoPlanes(radii(radius), *sums, ground * powers[:-1], powers[1:])


def profile(field: np.ndarray, radius: float) -> np.ndarray:
    """Values of a symmetric field at `radii`, (SAMPLES,): from the middle rows and columns, both ways."""
    n = len(field)
    middle = (field[n // 2 - 1 : n // 2 + 1].mean(0) + field[:, n // 2 - 1 : n // 2 + 1].mean(1)) / 2
    half = (middle[n // 2 :] + middle[: n // 2][::-1]) / 2
    return np.interp(radii(radius), (np.arange(n // 2) + 0.5) * CELL, half)


def two_planes(
    technique: str,
    ground: float,
    cloud: float,
    radius: float,
    bounces: int,
    exchange: Callable[[], Exchange] | None = None,
) -> TwoPlanes:
    """Sums by a technique: `exact` by quadrature over the radius, any other by its exchange on a grid."""
    if technique == "exact" or exchange is None:
        return solve(ground, cloud, radius, bounces, radii(radius))
    return on_grid(exchange(), ground, cloud, radius, bounces)
