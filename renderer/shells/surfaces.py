"""The surfaces that shells are put over: models of the state document, and their meshes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, TypeAdapter

from renderer.core.params import Model, param
from renderer.core.technique import Arrays
from renderer.shells import surface_grids
from renderer.shells.base_mesh import BaseMesh, vertex_normals


def repeats(around: str, default: float) -> Any:
    """The parameter of how often the texture repeats in a direction."""
    return param(
        default, label=f"Repeats {around}", help=f"How often the texture stands {around}.", cost="bake", gt=0, le=64
    )


class Plane(Model):
    """A level square."""

    kind: Literal["plane"] = "plane"
    size: float = param(2.0, label="Side", help="Of the square.", unit="m", cost="bake", ge=0.01, le=1000)
    divisions: int = param(4, label="Cells", help="Along a side.", cost="bake", ge=1, le=128)
    repeat_u: float = repeats("along x", 1.0)
    repeat_v: float = repeats("along y", 1.0)

    def mesh(self) -> BaseMesh:
        """Its triangles."""
        return surface_grids.plane(self.size, self.divisions, self.repeat_u, self.repeat_v)


class Sphere(Model):
    """A sphere."""

    kind: Literal["sphere"] = "sphere"
    radius: float = param(0.6, label="Radius", help="Of the sphere.", unit="m", cost="bake", ge=0.01, le=1000)
    layout: Literal["cube", "globe"] = param(
        "cube",
        label="Layout",
        help="A cube's six squares, each with the whole texture; or longitude and latitude, pinched at the poles.",
        cost="bake",
    )
    divisions: int = param(
        10, label="Cells", help="Along a square's side, or along a quarter of the equator.", cost="bake", ge=2, le=64
    )
    repeat_u: float = repeats("around, or along a square's side", 1.0)
    repeat_v: float = repeats("upwards", 1.0)

    def mesh(self) -> BaseMesh:
        """Its triangles."""
        if self.layout == "cube":
            return surface_grids.cube_sphere(self.radius, self.divisions, self.repeat_u, self.repeat_v)
        return surface_grids.globe(self.radius, 4 * self.divisions, self.repeat_u, self.repeat_v)


class Tube(Model):
    """An open cylinder that stands upright."""

    kind: Literal["tube"] = "tube"
    radius: float = param(0.35, label="Radius", help="Of the tube.", unit="m", cost="bake", ge=0.01, le=1000)
    length: float = param(1.6, label="Length", help="Of the tube.", unit="m", cost="bake", ge=0.01, le=1000)
    around: int = param(12, label="Cells around", help="The axis.", cost="bake", ge=3, le=256)
    along: int = param(5, label="Cells along", help="The axis.", cost="bake", ge=1, le=256)
    repeat_u: float = repeats("around", 2.0)
    repeat_v: float = repeats("along", 1.0)

    def mesh(self) -> BaseMesh:
        """Its triangles; 120 by default (Dufort 2005, table 6.1, which counts twelve for each)."""
        return surface_grids.tube(self.radius, self.length, self.around, self.along, self.repeat_u, self.repeat_v)


Surface = Annotated[Plane | Sphere | Tube, Field(discriminator="kind")]

_SURFACES: TypeAdapter[Plane | Sphere | Tube] = TypeAdapter(Surface)


def bake_surface(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """The mesh of a surface.

    Args:
        arguments: the document's `surface`, as `bake_arguments` gives it.

    Returns:
        `vertices` (V, 3) [m], `faces` (F, 3) int32, `corner_uv` (F, 3, 2), `normals` (V, 3) unit normals of the
        vertices, `notes` (N,) text.
    """
    progress(0.1, "making the surface")
    made = _SURFACES.validate_python(arguments).mesh()
    return {
        "vertices": made.vertices,
        "faces": made.faces,
        "corner_uv": made.corner_uv,
        "normals": vertex_normals(made.vertices, made.faces),
        "notes": np.array(made.notes, dtype=np.str_),
    }


def surface_of(arrays: Arrays) -> BaseMesh:
    """The mesh from what `bake_surface` gave."""
    notes = tuple(str(note) for note in arrays["notes"])
    return BaseMesh(arrays["vertices"], arrays["faces"], arrays["corner_uv"], notes)
