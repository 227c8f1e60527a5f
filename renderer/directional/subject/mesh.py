"""A user's mesh."""

from __future__ import annotations

from typing import Literal

import numpy as np

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import Model, param
from renderer.directional.subject.solid import Solid
from renderer.world.mesh import Mesh, MeshReading, load_mesh

Sides = Literal["file", "one", "both"]


class OwnMesh(Model):
    """An uploaded mesh."""

    kind: Literal["mesh"] = "mesh"
    asset: str = param(
        ..., label="File", help="An uploaded mesh, as asset:HASH.", cost="bake", pattern=r"^asset:[0-9a-f]{64}$",
        takes=("mesh",),
    )
    reading: MeshReading = param(MeshReading(), label="Reading", help="What the file leaves unsaid.", cost="bake")
    size: float = param(
        2.0, label="Size", help="Of its longest side, standing at the origin; 0 leaves it as it is.", unit="m",
        cost="bake", ge=0, le=1000,
    )
    sides: Sides = param(
        "file", label="Sides", cost="bake",
        help="Of its faces that are seen: as the file says, where open meshes have two; the front; or both.",
    )

    def solid(self) -> Solid:
        """Its triangles.

        Raises:
            InputError: the file cannot be had, or used.
        """
        try:
            mesh = load_mesh(AssetStore().get(self.asset.removeprefix("asset:")).path, reading=self.reading)
        except InputError as failure:
            inner = f"reading.{failure.field}" if failure.field in MeshReading.model_fields else "asset"
            raise failure.at(f"subject.{inner}") from None
        return solid_of(mesh, self.sides)


def solid_of(mesh: Mesh, sides: Sides = "file") -> Solid:
    """A mesh as a subject, with its own vertex normals where it has any."""
    normals = None
    if mesh.vertex_normals is not None:
        normals = mesh.vertex_normals[mesh.faces]
        own = mesh.face_normals()
        # A vertex normal behind its own face would make that corner black from all sides.
        behind = (normals * own[:, None]).sum(axis=-1, keepdims=True) <= 0
        normals = np.where(behind, own[:, None], normals)
    two_sided = mesh.two_sided if sides == "file" else sides == "both"
    return Solid(mesh.vertices, mesh.faces, mesh.face_colour, normals, two_sided, notes=mesh.notes)
