"""The meshes from which a pattern is planted: built-in species by weight, or the user's own tree."""

from __future__ import annotations

from typing import Any

import numpy as np

from renderer.core.cache import AssetStore
from renderer.core.errors import AssetError, InputError, LimitError
from renderer.forest.species import species
from renderer.forest.tree import Tree
from renderer.world.mesh import Mesh, MeshReading, load_mesh

VARIANTS = 4
"""Trees grown of each species."""

OWN_HEIGHT = 18.0
"""Height [m] to which a user's tree is scaled."""

OWN_REACH = 6.5
"""Widest reach [m] of a user's tree: an offset to the foot is stored in a byte (8 m), and a tile holds no wider
crown."""

MAX_FACES = 120_000
"""Most triangles of a user's tree: about a thousand trees stand in the pattern, at half a microsecond a triangle."""


def nursery(arguments: dict[str, Any]) -> tuple[list[Tree], np.ndarray, list[int]]:
    """Grow the trees of a canopy, or take the user's own.

    Args:
        arguments: the document's `canopy`: `mesh` and its `reading`, else the weights of the species by name; `seed`.

    Returns:
        The meshes, their shares (n,) summing to 1, and the number of each one's species.

    Raises:
        InputError: no species has any weight, or the uploaded mesh cannot serve as a tree.
    """
    if arguments.get("mesh"):
        try:
            reading = MeshReading.model_validate(arguments.get("reading", {}))
            mesh = load_mesh(AssetStore().get(str(arguments["mesh"]).removeprefix("asset:")).path, reading=reading)
        except InputError as failure:
            raise failure.at("canopy.mesh") from None
        return [own_tree(mesh)], np.ones(1), [len(species())]
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


def own_tree(mesh: Mesh) -> Tree:
    """A user's mesh as a tree: its foot at the origin, scaled to OWN_HEIGHT, or less where its crown would be too
    wide.

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
    scale = min(OWN_HEIGHT / height, OWN_REACH / max(reach, 1e-9))
    wood = np.zeros(len(mesh.faces), bool)
    return Tree(vertices * scale, mesh.faces.astype(np.int64), mesh.face_colour.astype(np.float32), wood)
