"""The meshes from which a pattern is planted: built-in species by weight, or the user's own trees."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError, InputError, LimitError
from renderer.forest.planting import BANDS
from renderer.world.mesh import Mesh, MeshReading, load_mesh
from renderer.world.species import species
from renderer.world.tree import Tree

VARIANTS = 4
"""Trees grown of each species."""

OWN_HEIGHT = 18.0
"""Height [m] to which the tallest of a user's trees is scaled."""

OWN_LEAST = 2.5
"""Least height [m] of any of several trees of a user's: four voxels."""

OWN_REACH = 6.5
"""Widest reach [m] of a user's tree: an offset to the foot is stored in a byte (8 m), and a tile holds no wider
crown."""

MAX_FACES = 120_000
"""Most triangles of a user's tree: about a thousand trees stand in the pattern, at half a microsecond a triangle."""


def nursery(arguments: dict[str, Any]) -> tuple[list[Tree], np.ndarray, list[int]]:
    """Grow the trees of a canopy, or take the user's own.

    Args:
        arguments: the document's `canopy`: `mesh`, one or several, and their `reading`, else the weights of the species
        by name; `seed`.

    Returns:
        The meshes, their shares (n,) summing to 1, and the number of each one's species.

    Raises:
        InputError: no species has any weight, or the uploaded mesh cannot serve as a tree.
    """
    if arguments.get("mesh"):
        own = own_trees([_mesh(asset, arguments) for asset in str(arguments["mesh"]).split()])
        return own, np.full(len(own), 1 / len(own)), [len(species()) + number for number in range(len(own))]
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


def listed(arguments: dict[str, Any]) -> dict[str, bool]:
    """What a species map may name, in the order of its values from 1, and whether any of it is planted.

    The built-in species stand in the order in which the document's `canopy` declares their weights, own trees in that
    of `mesh`.
    """
    if arguments.get("mesh"):
        return {f"tree {number}": True for number in range(1, len(str(arguments["mesh"]).split()) + 1)}
    return {name: value > 0 for name, value in arguments.items() if name in species()}


def bands_of(kinds: Sequence[int], arguments: dict[str, Any]) -> list[int]:
    """Place of each mesh's species in that list, from 0.

    Raises:
        LimitError: there are more own trees than a species map can tell apart.
    """
    names = list(listed(arguments))
    if len(names) > BANDS:
        raise LimitError(
            "canopy.mesh", f"has {len(names)} trees, each a species", f"at most {BANDS} with a species map"
        )
    if arguments.get("mesh"):
        return [kind - len(species()) for kind in kinds]
    return [names.index(list(species())[kind]) for kind in kinds]


def _mesh(asset: str, arguments: dict[str, Any]) -> Mesh:
    try:
        reading = MeshReading.model_validate(arguments.get("reading", {}))
        return load_mesh(AssetStore().get(asset.removeprefix("asset:")).path, reading=reading)
    except InputError as failure:
        raise failure.at("canopy.mesh") from None


def own_trees(meshes: Sequence[Mesh]) -> list[Tree]:
    """A user's meshes as trees of one forest: the tallest of OWN_HEIGHT, the others as tall beside it.

    Raises:
        AssetError: one has no height, or would be no taller than a shrub. LimitError: one has too many triangles.
    """
    heights = [float(np.ptp(mesh.vertices[np.unique(mesh.faces)][:, 2])) for mesh in meshes]
    made = []
    for number, (mesh, height) in enumerate(zip(meshes, heights, strict=True), start=1):
        wanted = OWN_HEIGHT * height / max(*heights, 1e-30)
        if 0 < wanted < OWN_LEAST:
            raise AssetError(
                "canopy.mesh",
                f"number {number} is {height:g} tall, where the tallest is {max(heights):g}",
                f"at least {OWN_LEAST / OWN_HEIGHT:.0%} of the tallest: are both in the same unit?",
            )
        made.append(own_tree(mesh, wanted))
    return made


def own_tree(mesh: Mesh, wanted: float = OWN_HEIGHT) -> Tree:
    """A user's mesh as a tree: its foot at the origin, scaled to the wanted height [m], or less where its crown would
    be too wide.

    Raises:
        AssetError: the mesh has no height.
        LimitError: it has more triangles than a thousand copies of it can be voxelised in reasonable time.
    """
    if len(mesh.faces) > MAX_FACES:
        raise LimitError("canopy.mesh", f"has {len(mesh.faces):,} triangles", f"at most {MAX_FACES:,}")
    used = mesh.vertices[np.unique(mesh.faces)]
    low, height = float(used[:, 2].min()), float(np.ptp(used[:, 2]))
    if height <= 0:
        raise AssetError("canopy.mesh", "is flat: a tree needs a height along z")
    # The stem is what stands on the ground: the lowest twentieth of the tree.
    foot = used[used[:, 2] <= low + 0.05 * height].mean(axis=0)
    vertices = mesh.vertices - [foot[0], foot[1], low]
    reach = float(np.hypot(*(used - foot)[:, :2].T).max())
    scale = min(wanted / height, OWN_REACH / max(reach, 1e-9))
    wood = np.zeros(len(mesh.faces), bool)
    return Tree(vertices * scale, mesh.faces.astype(np.int64), mesh.face_colour.astype(np.float32), wood)
