"""The bake of transfer matrices over one compute square, in any basis."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from renderer.clouds.radiosity.bases import (
    GRID,
    HAAR_CELLS,
    Basis,
    haar_basis,
    largest_wavelets,
    object_basis,
    solid_angle_basis,
)
from renderer.clouds.radiosity.relief import cast, nodes_of
from renderer.clouds.radiosity.solve import Answers, direct
from renderer.clouds.radiosity.transfer import Detail, Transfer, closed, flat_transfer, relief_transfer
from renderer.core.errors import InputError
from renderer.core.technique import Arrays

LEVEL = 1e-3
"""Ground whose heights differ by less, in heights of the base, is level."""

NOMINAL = 0.6
"""Reflectance of the cloud for which wavelets are chosen, where no better is known: that of an optical depth of ten."""

RENDERED = np.full((GRID, GRID), 0.2)
RENDERED[GRID // 4 : 3 * GRID // 4, GRID // 4 : 3 * GRID // 4] = 1.0
"""What light counts by place when wavelets are chosen: the square that is drawn, and what lights it from around."""


def bake_transfer(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> dict[str, np.ndarray]:
    """The matrices of one square, closed beyond its edge.

    Args:
        arguments: `basis` (kind), `coefficients`, `centre_height`, `rays` of each cell, `height` of the base over the
            elevation 0 in m, `scale` of the square against that of side 32H; a wider one is taken for level.
        inputs: `bounce_ground`, where relief counts: `elevation` (GRID, GRID) in m and the ground's `albedo` (GRID,
            GRID[, C]); without it all is level and even.

    Returns:
        `from_cloud`, `from_ground`, `on_ground`, and `relief_from_cloud`, `relief_from_ground`: what relief changes of
        them; of wavelets, which: `ground_kept`, `cloud_kept`.
    """
    ground = inputs.get("bounce_ground")
    elevation = np.zeros((GRID, GRID)) if ground is None else np.asarray(ground["elevation"]) / arguments["height"]
    albedo = np.full((GRID, GRID), 0.3) if ground is None else np.asarray(ground["albedo"], np.float64)
    if elevation.shape != (GRID, GRID):
        raise InputError("elevation", f"has {elevation.shape} cells", f"{GRID} x {GRID}")
    albedo = albedo.mean(axis=-1) if albedo.ndim == 3 else albedo
    hits = None
    if float(np.ptp(elevation)) >= LEVEL:
        hits = cast(nodes_of(elevation), arguments["rays"], lambda share, words: progress(0.8 * share, words))
    progress(0.8, "counting what rays met")

    detail, scale = Detail(albedo=albedo), arguments["scale"]

    def made(below: Basis, above: Basis) -> Transfer:
        found = (
            flat_transfer(below, above, detail, scale) if hits is None else relief_transfer(hits, below, above, detail)
        )
        return closed(found, below, above)

    kept: dict[str, np.ndarray] = {}
    if arguments["basis"] == "haar":
        kept = _wavelets(made, albedo, arguments["coefficients"])
        below, above = haar_basis(kept["ground_kept"]), haar_basis(kept["cloud_kept"])
    else:
        below = above = basis_of(arguments["basis"], arguments["coefficients"], arguments["centre_height"])
    found = made(below, above)
    level = closed(flat_transfer(below, above, detail, scale), below, above)
    return {
        **found.arrays(),
        **kept,
        "relief_from_cloud": found.from_cloud - level.from_cloud,
        "relief_from_ground": found.from_ground - level.from_ground,
    }


def basis_of(kind: str, coefficients: int, centre_height: float = 8.0) -> Basis:
    """A basis that needs no choice."""
    return object_basis(coefficients) if kind == "object" else solid_angle_basis(coefficients, centre_height)


def _wavelets(made: Callable[[Basis, Basis], Transfer], albedo: np.ndarray, coefficients: int) -> dict[str, np.ndarray]:
    """Which wavelets the light of an even cloud over this ground needs, found with all of them."""
    whole = haar_basis(np.arange(HAAR_CELLS * HAAR_CELLS))
    ground, cloud = full_solution(made(whole, whole), whole, albedo, np.full((GRID, GRID), NOMINAL), albedo, 0 * albedo)
    return {
        "ground_kept": largest_wavelets(np.stack([ground, ground / albedo.clip(1e-3)]), coefficients, RENDERED),
        "cloud_kept": largest_wavelets(cloud[None], coefficients, RENDERED),
    }


def full_solution(
    transfer: Transfer, whole: Basis, albedo: np.ndarray, reflectance: np.ndarray, ground: np.ndarray, cloud: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Radiosities of ground and base, (GRID, GRID) each, by every function of a basis.

    Args:
        ground, cloud: radiosities before any bounce.
    """
    answers = Answers.of(whole, whole, albedo, reflectance)
    first = whole.analyse(ground).astype(np.float32), whole.analyse(cloud).astype(np.float32)
    found = direct(transfer, answers, *first)
    return (
        whole.synthesise(answers.ground @ found[0] + first[0]),
        whole.synthesise(answers.cloud @ found[1] + first[1]),
    )
