"""Light between a terrain and a level cloud base, bounce by bounce: what `measure radiosity` gives for a file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from renderer.clouds.radiosity.bases import CELL, GRID, HALF, Basis, haar_basis, largest_wavelets
from renderer.clouds.radiosity.flat import bounce
from renderer.clouds.radiosity.kernel import flat_exchange
from renderer.clouds.radiosity.levels import ThreeLevelExchange
from renderer.clouds.radiosity.matrices import RENDERED, basis_of, full_solution
from renderer.clouds.radiosity.relief import cast
from renderer.clouds.radiosity.solve import Answers, by_bounces
from renderer.clouds.radiosity.transfer import Detail, relief_transfer
from renderer.core.errors import InputError
from renderer.core.quantity import Progress, Values
from renderer.world.terrain import crop, load_terrain

NODES = 129
"""Nodes along a side of the square into which a terrain is resampled: a quarter of a distance apart."""

Sums = list[tuple[np.ndarray, np.ndarray]]


def level_basis(kind: str, coefficients: int) -> Basis:
    """A basis for level planes: of wavelets the coarsest."""
    return haar_basis(np.arange(coefficients)) if kind == "haar" else basis_of(kind, coefficients)


def over_relief(given: Any, terrain: Path, progress: Progress) -> Values:
    """Sums after each bounce over the compute square of 32 distances around a terrain's middle.

    Args:
        given: arguments of the quantity. terrain: file.

    Raises:
        InputError: a technique of level planes alone, or ground that reaches the base.
    """
    if given.technique == "exact":
        raise InputError("technique", "exact knows level planes alone", "transfer, fft or three_level")
    if given.ground_albedo * given.cloud_albedo >= 1:
        raise InputError("ground_albedo", "nothing is absorbed", "a product of both albedos below 1")
    nodes = _nodes(terrain, given.distance)
    one = np.ones((GRID, GRID))
    progress(0.1, "rays between ground and clouds")
    if given.technique == "transfer":
        sums = _by_matrices(given, nodes, lambda share, words: progress(0.1 + 0.8 * share, words))
    else:
        exchange = (
            flat_exchange(GRID, CELL)
            if given.technique == "fft"
            else ThreeLevelExchange(GRID, CELL, 1.0, given.reading)
        )
        albedo, shine = given.ground_albedo * one[None], given.cloud_albedo * one[None]
        sums = []
        for count in range(1, given.bounces + 1):
            found = bounce(exchange, 0 * albedo, one[None], albedo, shine, 2 * count, tail=False)
            sums.append((found[0][0], found[1][0]))
    along = ((np.arange(GRID) + 0.5) * CELL - HALF) * given.distance
    blocks = nodes[:-1, :-1].reshape(GRID, (NODES - 1) // GRID, GRID, -1).mean(axis=(1, 3))
    return Values(
        {
            "ground_cum": given.ground_albedo * np.array([pair[0] for pair in sums])[:, ::-1],
            "cloud_cum": 1 + given.cloud_albedo * np.array([pair[1] for pair in sums])[:, ::-1],
            "x_m": along,
            "y_m": along[::-1].copy(),
            "elevation_m": blocks[::-1] * given.distance,
        },
        (
            "the cloud starts with radiosity 1, the ground with 0; sums after each bounce, the start included",
            "light is bounded by the square of 32 distances around the terrain's middle",
            "beyond the terrain its edge goes on",
            "the cloud base stands one distance above the terrain's lowest point",
        ),
    )


def _nodes(path: Path, distance: float) -> np.ndarray:
    """Heights over the lowest point in distances, (NODES, NODES), row 0 in the south."""
    side = 2 * HALF * distance
    found = crop(load_terrain(path), (0.0, 0.0), side * NODES / (NODES - 1), side / (NODES - 1)).elevation
    return (found - found.min())[::-1].astype(np.float64) / distance


def _by_matrices(given: Any, nodes: np.ndarray, progress: Callable[[float, str], None]) -> Sums:
    hits = cast(nodes, progress=progress)
    one = np.ones((GRID, GRID))
    albedo, shine = given.ground_albedo * one, given.cloud_albedo * one
    below = above = level_basis(given.basis, given.coefficients)
    if given.basis == "haar":
        whole = haar_basis(np.arange(32 * 32))
        matrices = relief_transfer(hits, whole, whole, Detail(edge=True))
        fields = full_solution(matrices, whole, albedo, shine, 0 * one, one)
        below, above = (haar_basis(largest_wavelets(field[None], given.coefficients, RENDERED)) for field in fields)
    matrices = relief_transfer(hits, below, above, Detail(edge=True))
    answers = Answers.of(below, above, albedo, shine)
    first = np.zeros(below.n, np.float32), above.analyse(one).astype(np.float32)
    sums = (by_bounces(matrices, answers, *first, 2 * count) for count in range(1, given.bounces + 1))
    return [(below.synthesise(ground), above.synthesise(cloud)) for ground, cloud in sums]
