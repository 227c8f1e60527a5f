"""Other meshes of the scene: opaque things that stand beside the shell, models of the state document and their meshes.

They hide the shell and each other, cast shadows on it and receive its own (Dufort 2005, section 5.3.1).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError, LimitError
from renderer.core.params import Colour, Model, Vector3, bake_arguments, param
from renderer.core.technique import Arrays
from renderer.shells.surface_mapping import MAX_TRIANGLES
from renderer.shells.surfaces import ASSET
from renderer.shells.thing_shapes import SHAPES, Shape, shape_of
from renderer.world.mesh import MeshReading, load_mesh

MOST_THINGS = 8
"""Things that a document may hold."""


def _position() -> Any:
    return param(
        (0.0, 0.0, -1.0), label="Place", help="Of the middle of its underside.", unit="m", cost="host"
    )


def _colour(default: tuple[float, float, float]) -> Any:
    return param(default, label="Colour", help="Its linear reflectance.", cost="host")


def _length(default: float, label: str, text: str) -> Any:
    return param(default, label=label, help=text, unit="m", cost="host", ge=0.001, le=1000)


class Ground(Model):
    """A level square."""

    kind: Literal["ground"] = "ground"
    position: Vector3 = _position()
    size: float = _length(12.0, "Side", "Of the square.")
    colour: Colour = _colour((0.3, 0.28, 0.25))

    def scale(self) -> tuple[float, float, float]:
        """Factors on its unit shape along x, y and z."""
        return self.size, self.size, 1.0


class Box(Model):
    """A box."""

    kind: Literal["box"] = "box"
    position: Vector3 = _position()
    width: float = _length(0.5, "Width", "Along x.")
    depth: float = _length(0.5, "Depth", "Along y.")
    height: float = _length(0.5, "Height", "Along z.")
    colour: Colour = _colour((0.45, 0.2, 0.12))

    def scale(self) -> tuple[float, float, float]:
        """Factors on its unit shape along x, y and z."""
        return self.width, self.depth, self.height


class Ball(Model):
    """A ball."""

    kind: Literal["ball"] = "ball"
    position: Vector3 = _position()
    radius: float = _length(0.25, "Radius", "Of the ball.")
    colour: Colour = _colour((0.5, 0.42, 0.12))

    def scale(self) -> tuple[float, float, float]:
        """Factors on its unit shape along x, y and z."""
        return self.radius, self.radius, self.radius


class Pedestal(Model):
    """A turned pedestal: a foot, a shaft and a plate to put something on."""

    kind: Literal["pedestal"] = "pedestal"
    position: Vector3 = _position()
    radius: float = _length(0.5, "Radius", "Of its plate.")
    height: float = _length(0.6, "Height", "Of all of it.")
    colour: Colour = _colour((0.6, 0.57, 0.52))

    def scale(self) -> tuple[float, float, float]:
        """Factors on its unit shape along x, y and z."""
        return self.radius, self.radius, self.height


class MeshThing(Model):
    """An uploaded mesh."""

    kind: Literal["asset"] = "asset"
    asset: str = param(
        ..., label="File", help="An uploaded mesh, as asset:HASH.", cost="bake", pattern=ASSET, takes=("mesh",)
    )
    reading: MeshReading = param(MeshReading(), label="Reading", help="What the file leaves unsaid.", cost="bake")
    position: Vector3 = _position()
    size: float = _length(1.0, "Size", "Of its longest side.")
    colour: Colour = param(
        (1.0, 1.0, 1.0), label="Colour", help="Factor on the file's own reflectance.", cost="host"
    )

    def scale(self) -> tuple[float, float, float]:
        """Factors on its unit shape along x, y and z."""
        return self.size, self.size, self.size


AnyThing = Ground | Box | Ball | Pedestal | MeshThing

Thing = Annotated[AnyThing, Field(discriminator="kind")]


class Things(Model):
    """Other meshes of the scene."""

    list: tuple[Thing, ...] = param(
        (), label="Things", help="Opaque meshes beside the shell.", cost="host", max_length=MOST_THINGS,
        source="Dufort 2005, section 5.3.1",
    )
    resolution: int = param(
        1024, label="Shadow texels", help="Along a side of the map of their shadows.", unit="px", cost="host", ge=16,
        le=4096,
    )


@dataclass(frozen=True)
class PlacedThings:
    """Things where they stand, triangle by triangle.

    Attributes:
        corners: (F, 3, 3) m. normals: (F, 3, 3) unit, smooth. albedo: (F, 3) linear reflectance. owner: (F,) number of
            the thing.
    """

    corners: np.ndarray
    normals: np.ndarray
    albedo: np.ndarray
    owner: np.ndarray


def placed_things(things: Things, shapes: Arrays) -> PlacedThings:
    """Things in the world.

    Args:
        shapes: arrays of `bake_things`.
    """
    begin = np.asarray(shapes["begin"])
    corners, normals, albedo = (np.array(shapes[name], np.float64) for name in ("corners", "normals", "albedo"))
    owner = np.repeat(np.arange(len(begin) - 1), np.diff(begin))
    for number, thing in enumerate(things.list):
        run = slice(int(begin[number]), int(begin[number + 1]))
        scale = np.array(thing.scale())
        corners[run] = corners[run] * scale + np.array(thing.position)
        turned = normals[run] / scale
        normals[run] = turned / np.linalg.norm(turned, axis=-1, keepdims=True)
        albedo[run] *= np.array(thing.colour)
    return PlacedThings(corners, normals, albedo, owner)


def thing_arguments(things: Things) -> dict[str, Any]:
    """What of the things is baked, as plain JSON values."""
    return {"list": [bake_arguments(thing) for thing in things.list]}


def bake_things(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> Arrays:
    """Unit shapes of things, their undersides in z = 0 around the origin.

    Args:
        arguments: of `thing_arguments`.

    Returns:
        `corners`, `normals` (F, 3, 3), `albedo` (F, 3), and `begin` (N + 1,), the first triangle of each thing.

    Raises:
        InputError: a file cannot be had, or used. LimitError: too many triangles.
    """
    shapes: list[Shape] = []
    for number, each in enumerate(arguments["list"]):
        progress(number / max(len(arguments["list"]), 1), "making the things")
        shapes.append(_of_file(number, each) if each["kind"] == "asset" else SHAPES[each["kind"]]())
        if sum(len(shape.corners) for shape in shapes) > 2 * MAX_TRIANGLES:
            raise LimitError(f"things.list.{number}", "has too many triangles", f"{2 * MAX_TRIANGLES:,} of all things")
    none = np.zeros((0, 3, 3))
    return {
        "corners": np.concatenate([none, *(shape.corners for shape in shapes)]),
        "normals": np.concatenate([none, *(shape.normals for shape in shapes)]),
        "albedo": np.concatenate([none[:, 0], *(shape.albedo for shape in shapes)]),
        "begin": np.cumsum([0, *(len(shape.corners) for shape in shapes)]),
    }


def _of_file(number: int, arguments: dict[str, Any]) -> Shape:
    field = f"things.list.{number}"
    try:
        path = AssetStore().get(arguments["asset"].removeprefix("asset:")).path
        mesh = load_mesh(path, reading=MeshReading.model_validate(arguments["reading"]))
    except InputError as failure:
        inner = f"reading.{failure.field}" if failure.field in MeshReading.model_fields else "asset"
        raise failure.at(f"{field}.{inner}") from None
    if len(mesh.faces) > MAX_TRIANGLES:
        raise LimitError(f"{field}.asset", f"has {len(mesh.faces):,} triangles", f"at most {MAX_TRIANGLES:,}")
    low, high = mesh.bounds
    foot = np.array([*(low + high)[:2] / 2, low[2]])
    return shape_of((mesh.vertices - foot) / float((high - low).max()), mesh.faces, mesh.face_colour)


def met(placed: PlacedThings, origin: np.ndarray, ray: np.ndarray) -> tuple[float, int]:
    """Distance [m] at which a ray first meets a thing, and the thing's number; infinity and -1 where it meets none.

    Source: Möller and Trumbore 1997, "Fast, minimum storage ray/triangle intersection".
    """
    a, b, c = (placed.corners[:, k] for k in range(3))
    along, across = b - a, c - a
    normal = np.cross(ray, across)
    size = (along * normal).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = ((origin - a) * normal).sum(axis=1) / size
        turned = np.cross(origin - a, along)
        v, t = (turned @ ray) / size, (turned * across).sum(axis=1) / size
        inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
    if not inside.any():
        return math.inf, -1
    first = int(np.argmin(np.where(inside, t, np.inf)))
    return float(t[first]), int(placed.owner[first])


def sphere_round(corners: np.ndarray) -> tuple[np.ndarray, float]:
    """Middle (3,) and radius [m] of a sphere that holds places (..., 3)."""
    places = corners.reshape(-1, 3)
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    return middle, math.sqrt(float(((places - middle) ** 2).sum(axis=1).max()))
