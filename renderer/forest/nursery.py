"""The meshes from which a pattern is planted: built-in species by weight, or the user's own tree."""

from __future__ import annotations

from typing import Any

import numpy as np

from renderer.core.errors import InputError
from renderer.forest.species import species
from renderer.forest.tree import Tree

VARIANTS = 4
"""Trees grown of each species."""


def nursery(arguments: dict[str, Any]) -> tuple[list[Tree], np.ndarray, list[int]]:
    """Grow the trees of a canopy.

    Args:
        arguments: the document's `canopy`.

    Returns:
        The meshes, their shares (n,) summing to 1, and the number of each one's species.

    Raises:
        InputError: no species has any weight.
    """
    meshes: list[Tree] = []
    shares: list[float] = []
    kinds: list[int] = []
    for number, (name, kind) in enumerate(species().items()):
        weight = float(arguments.get(name, 0.0))
        if weight <= 0:
            continue
        for variant in range(VARIANTS):
            meshes.append(kind.sample(1000 * int(arguments["seed"]) + 100 * number + variant))
            shares.append(weight)
            kinds.append(number)
    if not meshes:
        raise InputError("canopy", "has no species with a weight above 0", "a weight up to 1 for one species at least")
    return meshes, np.array(shares) / sum(shares), kinds
