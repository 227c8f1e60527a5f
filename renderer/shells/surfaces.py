"""The surfaces that shells are put over: models of the state document, and their meshes."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, TypeAdapter

from renderer.core.params import Model, param
from renderer.core.technique import Arrays
from renderer.shells import surface_grids
from renderer.shells.base_mesh import BaseMesh
from renderer.shells.surface_mapping import Mapping, load_surface
from renderer.shells.surface_teapot import teapot
from renderer.shells.surface_turned import MUSHROOM, VASE, turned_curve
from renderer.world.mesh import MeshReading
from renderer.world.mesh_normals import vertex_normals

ASSET = r"^asset:[0-9a-f]{64}$"


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


class Teapot(Model):
    """Newell's teapot."""

    kind: Literal["teapot"] = "teapot"
    size: float = param(
        1.6, label="Size", help="From the handle to the spout's mouth.", unit="m", cost="bake", ge=0.01, le=1000,
        source="Newell 1975",
    )
    detail: int = param(1, label="Detail", help="Into how many each side of a cell is cut.", cost="bake", ge=1, le=4)
    repeat_u: int = param(
        8, label="Repeats around", help="How often the texture stands around the body.", cost="bake", ge=1, le=64
    )
    repeat_v: float = repeats("up the body", 3.0)

    def mesh(self) -> BaseMesh:
        """Its triangles; 2,142 by default (Dufort 2005, table 6.1)."""
        return teapot(self.size, self.detail, self.repeat_u, self.repeat_v)


class Vase(Model):
    """A vase, open above."""

    kind: Literal["vase"] = "vase"
    height: float = param(1.6, label="Height", help="Of the vase.", unit="m", cost="bake", ge=0.01, le=1000)
    around: int = param(64, label="Cells around", help="The axis.", cost="bake", ge=3, le=256)
    along: int = param(68, label="Cells along", help="From the foot's middle to the lip.", cost="bake", ge=4, le=256)
    repeat_u: float = repeats("around", 8.0)
    repeat_v: float = repeats("from the foot's middle to the lip", 7.0)

    def mesh(self) -> BaseMesh:
        """Its triangles; 8,640 by default (Dufort 2005, table 6.1)."""
        return turned_curve(VASE, self.height, self.around, self.along, self.repeat_u, self.repeat_v)


class Mushroom(Model):
    """A mushroom: a hollow under its cap, which a thick shell does not fit into."""

    kind: Literal["mushroom"] = "mushroom"
    height: float = param(1.2, label="Height", help="Of the mushroom.", unit="m", cost="bake", ge=0.01, le=1000)
    around: int = param(40, label="Cells around", help="The axis.", cost="bake", ge=3, le=256)
    along: int = param(36, label="Cells along", help="From the foot's middle to the top.", cost="bake", ge=4, le=256)
    repeat_u: float = repeats("around", 6.0)
    repeat_v: float = repeats("from the foot's middle to the top", 5.0)

    def mesh(self) -> BaseMesh:
        """Its triangles."""
        return turned_curve(MUSHROOM, self.height, self.around, self.along, self.repeat_u, self.repeat_v)


class Planks(Model):
    """Planks in a ring, each with one end over the next: seen from above their cells have no order.

    Cut in two along their length they have one: no cell then lies over one plank and under another.
    """

    kind: Literal["planks"] = "planks"
    count: int = param(3, label="Planks", help="In the ring.", cost="bake", ge=3, le=24)
    radius: float = param(
        0.3, label="Radius", help="Of the circle that they touch.", unit="m", cost="bake", gt=0, le=1000
    )
    width: float = param(0.2, label="Width", help="Of each.", unit="m", cost="bake", gt=0, le=1000)
    tilt: float = param(
        14.0, label="Tilt", help="By which they rise along the ring.", unit="deg", cost="bake", ge=0, le=60
    )
    along: int = param(1, label="Cells along", help="Each plank.", cost="bake", ge=1, le=256)
    repeat: float = repeats("across each", 1.0)

    def mesh(self) -> BaseMesh:
        """Its triangles."""
        tilt = math.radians(self.tilt)
        return surface_grids.planks(self.count, self.radius, self.width, tilt, self.along, self.repeat)


class UserMesh(Model):
    """An uploaded mesh."""

    kind: Literal["asset"] = "asset"
    asset: str = param(
        ..., label="File", help="An uploaded mesh, as asset:HASH.", cost="bake", pattern=ASSET, takes=("mesh",)
    )
    reading: MeshReading = param(MeshReading(), label="Reading", help="What the file leaves unsaid.", cost="bake")
    size: float = param(
        1.5,
        label="Size",
        help="Of its longest side, with its middle at the origin; 0 leaves it as it is.",
        unit="m",
        cost="bake",
        ge=0,
        le=1000,
    )
    mapping: Mapping = param(
        "file",
        label="Texture coordinates",
        help="The file's own (those of a box where it has none), or by a box, a cylinder, a sphere, or from above.",
        cost="bake",
    )
    repeat_u: float = repeats("along u", 1.0)
    repeat_v: float = repeats("along v", 1.0)

    def mesh(self) -> BaseMesh:
        """Its triangles.

        Raises:
            InputError: the file cannot be had, or used.
        """
        return load_surface(self.model_dump(mode="json"))


AnySurface = Plane | Sphere | Tube | Teapot | Vase | Mushroom | Planks | UserMesh

Surface = Annotated[AnySurface, Field(discriminator="kind")]

_SURFACES: TypeAdapter[AnySurface] = TypeAdapter(Surface)


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
