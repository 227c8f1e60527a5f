"""Where a tabulated reflectance comes from: built-in tables and the user's files, and the bake that makes one."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, TypeAdapter

from renderer.core.cache import AssetStore
from renderer.core.errors import InputError
from renderer.core.params import Colour, Model, bake_arguments, param, radians_of
from renderer.core.technique import Arrays, Bake
from renderer.directional.brdf import models
from renderer.directional.brdf.resident import rulers, tiles_across
from renderer.world.brdf import AXES, BrdfTable, direction_of, made_one_at_the_pole
from renderer.world.brdf_files import load_brdf

ASSET = r"^asset:[0-9a-f]{64}$"


def degrees(first: float, last: float, step: float) -> np.ndarray:
    """Nodes from first to last, both in degrees, as radians."""
    return np.asarray(np.radians(np.arange(first, last + step / 2, step)))


ONE = np.zeros(1)
"""The node of an axis that a table does not have."""


def hats(phi: np.ndarray) -> np.ndarray:
    """Weights (..., 3) of red, green and blue: 1 at 0, 120 and 240 degrees, falling to 0 at the others; 1 together."""
    third = 2 * math.pi / 3
    away = np.abs(np.mod(phi[..., None] - third * np.arange(3) + math.pi, 2 * math.pi) - math.pi)
    return np.asarray(np.maximum(1 - away / third, 0))


def ramp(theta: np.ndarray, full: float) -> np.ndarray:
    """0 at the normal, 1 at `full` degrees, 0.7 at the horizon, straight between."""
    return np.asarray(np.interp(theta, np.radians([0.0, full, 90.0]), [0.0, 1.0, 0.7]))


class Validation(Model):
    """Red, green or blue by the directions of light and view, as Porquet 2005 proves his indices."""

    kind: Literal["validation"] = "validation"
    azimuths: Literal["difference", "both"] = param(
        "difference",
        label="Azimuths",
        help="Whether the light's azimuth counts from the view's, or both from the surface's tangent.",
        cost="bake",
        source="Porquet 2005, section 3.3.2.2; errata 003-4",
    )
    reflectance: float = param(0.4, label="Reflectance", help="Of each colour.", unit="ratio", cost="bake", ge=0, le=1)

    def colours(self, place: tuple[np.ndarray, ...]) -> np.ndarray:
        """The rule, (..., 3) [sr-1], which interpolation between the table's nodes keeps everywhere.

        Towards the normal it is white. With the difference of azimuths, red is light from the view's side, green a
        third of a turn on, blue two thirds. With both, the light's azimuth from the tangent says the same to who looks
        along the normal, and the view's azimuth turns the colours back by itself as the view is lowered. View and light
        have ramps of their own, so that exchanging them shows.

        Args:
            place: theta_o, phi_o (any, if the difference counts), theta_l, and phi_l or delta_phi [rad].
        """
        theta_o, phi_o, theta_l, phi_l = place
        white = 1 / 3
        seen, lit = ramp(theta_o, 15.0)[..., None], ramp(theta_l, 30.0)[..., None]
        turned = hats(phi_l)
        if self.azimuths == "both":
            back = sum(hats(phi_o)[..., j, None] * np.roll(turned, -j, axis=-1) for j in range(3))
            share = (1 - seen) * turned + seen * back
            colours = white + lit * (share - white)
        else:
            colours = white + seen * lit * (turned - white)
        return np.asarray(3 / math.pi * self.reflectance * colours)

    def table(self) -> BrdfTable:
        """It, at every 15 degrees."""
        theta, phi = degrees(0, 90, 15), degrees(0, 345, 15)
        nodes = (theta, phi if self.azimuths == "both" else ONE, theta, phi)
        values = self.colours(tuple(np.meshgrid(*nodes, indexing="ij")))
        return BrdfTable("angles" if self.azimuths == "both" else "difference", nodes, values)


class Satin(Model):
    """Woven satin: a bright sheen across the threads, by a published model sampled onto a table with both azimuths."""

    kind: Literal["satin"] = "satin"
    colour: Colour = param((0.35, 0.03, 0.06), label="Colour", help="Of the cloth.", cost="bake")
    sheen: Colour = param((0.22, 0.17, 0.17), label="Sheen", help="Reflectance of the threads facing it.", cost="bake")
    along: float = param(
        3.0,
        label="Along",
        help="Exponent of the sheen along the tangent.",
        cost="bake",
        ge=1,
        le=60,
        source="Ashikhmin & Shirley 2000",
    )
    across: float = param(
        30.0,
        label="Across",
        help="Exponent of the sheen along the bitangent.",
        cost="bake",
        ge=1,
        le=60,
        source="Ashikhmin & Shirley 2000",
    )

    def reflectance(self, view: np.ndarray, light: np.ndarray) -> np.ndarray:
        """The model itself, (..., 3) [sr-1]."""
        colours = np.array(self.colour), np.array(self.sheen)
        return models.ashikhmin_shirley(view, light, *colours, self.along, self.across)

    def table(self) -> BrdfTable:
        """It, at every 10 degrees down to 80, at 85, and at every 10 degrees of azimuth.

        Between nodes it errs by 1 % (median), at a low view and light across the sheen by up to a third.
        """
        theta, phi = np.append(degrees(0, 80, 10), math.radians(85)), degrees(0, 350, 10)
        return sampled("angles", (theta, phi, theta, phi), self.reflectance)


class Matte(Model):
    """Matt clay or paper: rough Lambertian facets, sampled onto a table without a grain."""

    kind: Literal["matte"] = "matte"
    colour: Colour = param((0.62, 0.55, 0.45), label="Colour", help="Of the facets.", cost="bake")
    roughness: float = param(
        30.0,
        label="Roughness",
        help="Standard deviation of the facets' slope.",
        unit="deg",
        cost="bake",
        ge=0,
        le=60,
        source="Oren & Nayar 1994",
    )

    def reflectance(self, view: np.ndarray, light: np.ndarray) -> np.ndarray:
        """The model itself, (..., 3) [sr-1]."""
        facets = models.oren_nayar(view, light, radians_of(self, "roughness"))
        return np.asarray(facets[..., None] * np.array(self.colour))

    def table(self) -> BrdfTable:
        """It, at every 7.5 degrees from the normal and every 15 of azimuth."""
        theta = degrees(0, 90, 7.5)
        return sampled("difference", (theta, ONE, theta, degrees(0, 345, 15)), self.reflectance)


class Metal(Model):
    """Rough metal, sampled over half vectors as the files of Matusik et al. are."""

    kind: Literal["metal"] = "metal"
    colour: Colour = param((1.0, 0.71, 0.29), label="Colour", help="Reflectance facing it.", cost="bake")
    roughness: float = param(
        0.3, label="Roughness", help="Alpha of GGX.", cost="bake", ge=0.05, le=1, source="Walter et al. 2007"
    )

    def reflectance(self, view: np.ndarray, light: np.ndarray) -> np.ndarray:
        """The model itself, (..., 3) [sr-1]."""
        return models.metal(view, light, np.array(self.colour), self.roughness)

    def table(self, cells: tuple[int, int, int] = (48, 24, 12)) -> BrdfTable:
        """It, in cells of the half angle, dense near the normal, of the light's angle to it and of its azimuth."""
        root, theta, phi = ((np.arange(count) + 0.5) / count for count in cells)
        nodes = root, ONE, theta * (0.5 * math.pi), phi * math.pi
        root, _, theta_d, phi_d = np.meshgrid(*nodes, indexing="ij")
        theta_h = root**2 * (0.5 * math.pi)
        upward = np.cos(theta_d) * np.cos(theta_h)
        across = np.sin(theta_d) * np.cos(phi_d) * np.sin(theta_h)
        low = 1e-3
        cosines = np.maximum(upward + across, low), np.maximum(upward - across, low), np.cos(theta_h), np.cos(theta_d)
        return BrdfTable("half", nodes, models.metal_of(*cosines, np.array(self.colour), self.roughness))


class File(Model):
    """A user's own table: a file of Matusik et al. 2003 (MERL), or an .npz."""

    kind: Literal["file"] = "file"
    asset: str = param(
        ..., label="File", help="An uploaded reflectance, as asset:HASH.", cost="bake", pattern=ASSET, takes=("brdf",)
    )

    def table(self) -> BrdfTable:
        """It, as the file has it.

        Raises:
            InputError: the file cannot be had, or used.
        """
        try:
            table = load_brdf(AssetStore().get(self.asset.removeprefix("asset:")).path)
            rulers(table), tiles_across(table.values.shape)  # refused here, where the document can be named
            return table
        except InputError as failure:
            raise failure.at("material.asset") from None


AnyMaterial = Validation | Satin | Matte | Metal | File
Material = Annotated[AnyMaterial, Field(discriminator="kind")]

_ANY: TypeAdapter[AnyMaterial] = TypeAdapter(Material)


def sampled(
    coordinates: Literal["angles", "difference"],
    nodes: tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray],
    model: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> BrdfTable:
    """A model's values at nodes."""
    theta_o, phi_o, theta_l, phi_l = np.meshgrid(*nodes, indexing="ij")
    values = model(direction_of(theta_o, phi_o), direction_of(theta_l, phi_l))
    return made_one_at_the_pole(BrdfTable(coordinates, nodes, values))


def brdf_bake(material: AnyMaterial) -> Bake:
    """The precomputation of a table."""
    seconds = 2 if material.kind == "file" else 0.5
    return Bake("brdf", bake_brdf, bake_arguments(material), version=2, seconds=seconds)


def bake_brdf(
    arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]
) -> dict[str, np.ndarray]:
    """A table as arrays.

    Args:
        arguments: a `Material` as a document.

    Returns:
        `coordinates` (), the place of its name among `AXES`; `nodes_0` to `nodes_3`; `values` float32 [sr-1].
    """
    progress(0.1, "making the reflectance table")
    table = _ANY.validate_python(arguments).table()
    nodes = {f"nodes_{axis}": nodes for axis, nodes in enumerate(table.nodes)}
    order = np.array(tuple(AXES).index(table.coordinates))
    return {"coordinates": order, "values": table.values.astype(np.float32), **nodes}


def table_of(arrays: Arrays) -> BrdfTable:
    """The table of a bake's arrays."""
    coordinates = tuple(AXES)[int(arrays["coordinates"])]
    return BrdfTable(
        coordinates,
        (arrays["nodes_0"], arrays["nodes_1"], arrays["nodes_2"], arrays["nodes_3"]),
        arrays["values"],
    )
