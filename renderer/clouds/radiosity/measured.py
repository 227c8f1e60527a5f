"""Two planes cut to discs, bounce by bounce, as any of the techniques computes them: what `measure radiosity` gives."""

from __future__ import annotations

import numpy as np

from renderer.clouds.radiosity.bases import CELL as SQUARE_CELL
from renderer.clouds.radiosity.bases import GRID, Basis
from renderer.clouds.radiosity.flat import Exchange
from renderer.clouds.radiosity.form_factors import LEVELS, Reading
from renderer.clouds.radiosity.kernel import FlatExchange
from renderer.clouds.radiosity.levels import ThreeLevelExchange
from renderer.clouds.radiosity.solve import Answers, by_bounces
from renderer.clouds.radiosity.transfer import Detail, flat_transfer
from renderer.clouds.radiosity.two_planes import TwoPlanes

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


def coverage(radius: float, n: int, cell: float = CELL) -> np.ndarray:
    """Share of each cell of a grid that lies inside the disc, (N, N)."""
    places = ((np.arange(n * FINE) + 0.5) / FINE - n / 2) * cell
    inside = places[:, None] ** 2 + places[None, :] ** 2 <= radius * radius
    return inside.reshape(n, FINE, n, FINE).mean(axis=(1, 3))


def on_grid(exchange: Exchange, ground: float, cloud: float, radius: float, bounces: int) -> TwoPlanes:
    """The bounces of two planes cut to a disc, on a grid; the cloud starts with radiosity 1, the ground with 0.

    Args:
        exchange: of one half-bounce on the disc's grid. ground, cloud: albedo of either. radius: in heights.

    Returns:
        the sums along the four axes' mean, between cells' middles linearly.
    """
    inside = coverage(radius, grid_size(radius))
    # Sums are those of the whole planes, so that what covers a part of a cell is not diluted by the rest of it.
    leaving, total_ground, total_cloud = inside, np.zeros_like(inside), np.ones_like(inside)
    found = []
    for _ in range(bounces):
        from_cloud = ground * exchange(leaving)
        from_ground = cloud * exchange(inside * from_cloud)
        total_ground, total_cloud = total_ground + from_cloud, total_cloud + from_ground
        leaving = inside * from_ground
        found.append((profile(total_ground, radius), profile(total_cloud, radius)))
    sums = np.array([pair[0] for pair in found]), np.array([pair[1] for pair in found])
    return TwoPlanes(radii(radius), *sums, *_endless(ground, cloud, bounces))


def profile(field: np.ndarray, radius: float, cell: float = CELL) -> np.ndarray:
    """Values of a symmetric field at `radii`, (SAMPLES,): from the middle rows and columns, both ways."""
    n = len(field)
    middle = (field[n // 2 - 1 : n // 2 + 1].mean(0) + field[:, n // 2 - 1 : n // 2 + 1].mean(1)) / 2
    half = (middle[n // 2 :] + middle[: n // 2][::-1]) / 2
    return np.interp(radii(radius), (np.arange(n // 2) + 0.5) * cell, half)


def by_matrices(basis: Basis, ground: float, cloud: float, radius: float, bounces: int) -> TwoPlanes:
    """The same by transfer matrices in a basis on the compute square.

    Args:
        radius: in heights; at most half of the square's side.
    """
    inside = coverage(radius, GRID, SQUARE_CELL)
    detail = Detail(np.maximum(inside, 1e-6), np.maximum(inside, 1e-6))
    answers = Answers.of(basis, basis, ground * inside, cloud * inside)
    first = np.zeros(basis.n, np.float32), basis.analyse(inside).astype(np.float32)
    transfer = flat_transfer(basis, basis, detail)
    found = []
    for count in range(1, bounces + 1):
        sums = (basis.synthesise(side) for side in by_bounces(transfer, answers, *first, 2 * count))
        found.append([profile(field, radius, SQUARE_CELL) for field in sums])
    return TwoPlanes(
        radii(radius),
        ground * np.array([pair[0] for pair in found]),
        1 + cloud * np.array([pair[1] for pair in found]),
        *_endless(ground, cloud, bounces),
    )


def _endless(ground: float, cloud: float, bounces: int) -> tuple[np.ndarray, np.ndarray]:
    powers = np.cumsum((ground * cloud) ** np.arange(bounces + 1))
    return ground * powers[:-1], powers[1:]
