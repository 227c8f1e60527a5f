"""How a shell stands on its surface: the model of the state document, and the offset of every vertex."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field
from scipy import ndimage

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import Model, Vector3, param
from renderer.shells.base_mesh import BaseMesh
from renderer.shells.clamp import Clamped, Conflicts, Prisms, facing_directions
from renderer.world.maps import load_map
from renderer.world.mesh_normals import vertex_normals

ASSET = r"^asset:[0-9a-f]{64}$"

WAVES = 12
"""Plane waves that the noise is made of."""

MOST_DABS = 256
"""Strokes of paint that a document may hold."""


class EvenThickness(Model):
    """The same everywhere."""

    kind: Literal["even"] = "even"


class NoisyThickness(Model):
    """Thinner here and there, by chance."""

    kind: Literal["noise"] = "noise"
    amount: float = param(
        0.6, label="Amount", help="How much of the thickness is taken.", unit="ratio", cost="bake", ge=0, le=0.98
    )
    size: float = param(
        0.5, label="Size", help="From one thin place to the next.", unit="m", cost="bake", gt=0, le=1000
    )
    seed: int = param(1, label="Seed", help="Of the places.", cost="bake", ge=0, le=2**31 - 1)


class MappedThickness(Model):
    """By an uploaded map over the texture coordinates, which repeats as the texture does."""

    kind: Literal["asset"] = "asset"
    asset: str = param(
        ...,
        label="File",
        help="An uploaded picture (black is thinnest) or array `thickness`, as asset:HASH.",
        cost="bake",
        pattern=ASSET,
        takes=("map", "image"),
    )
    thinnest: float = param(
        0.05, label="Thinnest", help="Share of it where the map is 0.", unit="ratio", cost="bake", ge=0.02, le=1
    )
    full: float = param(
        0.0,
        label="Value of the whole thickness",
        help="What the map has for it; 0 takes the largest value of the file's type.",
        cost="bake",
        ge=0,
        le=1e6,
    )


Relief = Annotated[EvenThickness | NoisyThickness | MappedThickness, Field(discriminator="kind")]


class Dab(Model):
    """A stroke of paint on the thickness: all of it in the middle, none at the radius."""

    at: Vector3 = param((0.0, 0.0, 0.0), label="Place", help="Of its middle.", unit="m", cost="bake")
    radius: float = param(0.2, label="Radius", help="How far it reaches.", unit="m", cost="bake", gt=0, le=1000)
    factor: float = param(
        0.5, label="Factor", help="Of the thickness in its middle.", unit="ratio", cost="bake", ge=0.02, le=4
    )


class Extrusion(Model):
    """How a shell stands on its surface."""

    thickness: float = param(
        0.08, label="Thickness", help="Of the shell.", unit="m", cost="bake", gt=0, le=1000,
        source="Dufort 2005, section 3.1",
    )
    direction: Literal["normal", "up", "fixed"] = param(
        "normal", label="Direction", help="Along the normals, upwards, or all one way.", cost="bake"
    )
    azimuth: float = param(
        0.0, label="Azimuth", help="Of the one way, from north by east.", unit="deg", cost="bake", ge=-360, le=360
    )
    elevation: float = param(
        60.0, label="Elevation", help="Of the one way, above the horizon.", unit="deg", cost="bake", ge=-90, le=90
    )
    relief: Relief = param(EvenThickness(), label="Relief", help="Where the shell is thinner.", cost="bake")
    paint: tuple[Dab, ...] = param(
        (), label="Paint", help="Strokes that make it thinner or thicker.", cost="bake", max_length=MOST_DABS
    )
    clamp: bool = param(
        True,
        label="Clamp",
        help="Makes the shell thinner where it would meet itself.",
        cost="bake",
        source="Peng, Kristjansson and Zorin 2004",
    )


@dataclass(frozen=True)
class Extruded:
    """Where a shell stands.

    Args:
        offset: (V, 3) from each vertex to its copy, m.
        length: (V,) what was wanted, m.
        turned: (V,) bool, whose direction was turned to face all of its triangles.
        clamped: shares of the lengths that were kept, and the conflicts before and after.
    """

    offset: np.ndarray
    length: np.ndarray
    turned: np.ndarray
    clamped: Clamped


def extrude(base: BaseMesh, extrusion: Extrusion) -> Extruded:
    """The offsets of a shell over a mesh.

    Raises:
        InputError: `extrusion.relief.asset` cannot be had, or used.
        LimitError: `extrusion.thickness` brings too many prisms together.
    """
    length = lengths(base, extrusion)
    direction, turned = directions(base.vertices, base.faces, extrusion)
    prisms = Prisms(base.vertices, base.faces)
    wanted = direction * length[:, None]
    if extrusion.clamp:
        clamped = prisms.clamp(wanted)
    else:
        found: Conflicts = prisms.conflicts(wanted)
        clamped = Clamped(np.ones(len(length)), found, found, np.empty((0, 2), np.int32))
    return Extruded(wanted * clamped.share[:, None], length, turned, clamped)


def directions(vertices: np.ndarray, faces: np.ndarray, extrusion: Extrusion) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (V, 3) along which the vertices are displaced, and which had to be turned, (V,) bool.

    Along normals each is turned, where it must be, to face all triangles around it: a sharp spike's mean normal may
    point behind one of them.
    """
    if extrusion.direction == "normal":
        return facing_directions(vertex_normals(vertices, faces), vertices, faces)
    upwards = math.radians(90.0 if extrusion.direction == "up" else extrusion.elevation)
    around = math.radians(extrusion.azimuth)
    level = math.cos(upwards)
    way = np.array([level * math.sin(around), level * math.cos(around), math.sin(upwards)])
    return np.tile(way, (len(vertices), 1)), np.zeros(len(vertices), bool)


def lengths(base: BaseMesh, extrusion: Extrusion) -> np.ndarray:
    """Wanted length of each vertex' offset, (V,) [m]: the thickness by relief and paint.

    Raises:
        InputError: `extrusion.relief.asset`.
    """
    relief = extrusion.relief
    factor = np.ones(len(base.vertices))
    if isinstance(relief, NoisyThickness):
        factor = 1 - relief.amount * noise(base.vertices, relief.size, relief.seed)
    elif isinstance(relief, MappedThickness):
        factor = relief.thinnest + (1 - relief.thinnest) * _mapped(base, relief)
    for dab in extrusion.paint:
        away = np.linalg.norm(base.vertices - dab.at, axis=1) / dab.radius
        weight = np.where(away < 1, (1 - away**2) ** 2, 0.0)
        factor = factor * (1 + (dab.factor - 1) * weight)
    return extrusion.thickness * factor


def noise(places: np.ndarray, size: float, seed: int) -> np.ndarray:
    """Smooth noise in [0, 1] at places (N, 3): plane waves of length `size` [m] all ways, at phases by chance."""
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(WAVES, 3))
    way *= 2 * math.pi / size / np.linalg.norm(way, axis=1, keepdims=True)
    total = np.sin(places @ way.T + rng.uniform(0, 2 * math.pi, WAVES)).sum(axis=1)
    # The sum of N waves spreads by sqrt(N / 2): within 1.5 of that, nine tenths of it.
    return np.clip(0.5 + total / (3 * math.sqrt(WAVES / 2)), 0.0, 1.0)


def _mapped(base: BaseMesh, relief: MappedThickness) -> np.ndarray:
    """The map in [0, 1] at each vertex, the mean over its corners; between pixels' centres bilinear, repeating."""
    try:
        path = AssetStore().get(relief.asset.removeprefix("asset:")).path
        values, full = load_map(path, "thickness")
    except InputError as failure:
        raise failure.at("extrusion.relief.asset", ("file", "asset", "thickness")) from None
    share = np.clip(values / (relief.full or full), 0.0, 1.0)
    uv = base.corner_uv.reshape(-1, 2)
    rows, columns = share.shape
    at = [(1 - uv[:, 1]) * rows - 0.5, uv[:, 0] * columns - 0.5]
    read = ndimage.map_coordinates(share, at, order=1, mode="grid-wrap")
    count = len(base.vertices)
    sums = np.bincount(base.faces.ravel(), read, count)
    mean: Any = sums / np.bincount(base.faces.ravel(), minlength=count)
    return np.asarray(mean)
