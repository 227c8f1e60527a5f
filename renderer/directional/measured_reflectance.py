"""The quantity `reflectance`: what a surface sends of the light from one direction into another."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, field_validator

from renderer.core.errors import AssetError, InputError, LimitError
from renderer.core.params import Colour, Model, param
from renderer.core.quantity import InputFile, Progress, Quantity, Values
from renderer.directional.brdf import models
from renderer.directional.brdf.lookup import lookup
from renderer.directional.brdf.materials import Matte, Metal, Satin, Validation
from renderer.world.arrays import read_npz
from renderer.world.brdf import BrdfTable, direction_of
from renderer.world.brdf_files import load_brdf
from renderer.world.limits import DEFAULT_LIMITS, check_file

MOST = 100_000
"""Most pairs of directions at once."""

VIEWS = 500
"""Most view directions whose albedo is summed: some ten seconds of one core."""

RINGS = 64
"""Rings of lights that an albedo is summed over, with four times as many azimuths."""

PAIRS = 2000
"""Random pairs of directions over which reciprocity is judged."""

MIRRORED = ((45.0, 180.0, 45.0, 0.0),)
"""What is asked for where nothing is: a mirror's direction, in degrees."""

Polar = Annotated[float, Field(ge=0, le=90)]
Azimuth = Annotated[float, Field(ge=-360, le=360)]
Reflectance = Callable[[np.ndarray, np.ndarray], np.ndarray]


class PhongLobe(Model):
    """Phong's normalised lobe over a matt colour."""

    kind: Literal["phong"] = "phong"
    diffuse: Colour = param((0.5, 0.5, 0.5), label="Diffuse", help="Matt reflectance.", cost="host")
    specular: float = param(0.2, label="Specular", help="Share of the lobe.", cost="host", ge=0, le=1)
    shininess: float = param(
        40.0, label="Shininess", help="Exponent.", cost="host", ge=1, le=1e5, source="Lafortune & Willems 1994"
    )

    def reflectance(self, view: np.ndarray, light: np.ndarray) -> np.ndarray:
        """Its value, (..., 3) [sr-1]."""
        return models.phong(view, light, np.array(self.diffuse), self.specular, self.shininess)


class LafortuneLobe(Model):
    """A generalised cosine lobe over a matt colour."""

    kind: Literal["lafortune"] = "lafortune"
    diffuse: Colour = param((0.3, 0.3, 0.3), label="Diffuse", help="Matt reflectance.", cost="host")
    colour: tuple[Annotated[float, Field(ge=0, le=1e6)], Annotated[float, Field(ge=0, le=1e6)],
                  Annotated[float, Field(ge=0, le=1e6)]] = param(
        (0.5, 0.5, 0.5), label="Colour", help="Of the lobe, sr-1.", cost="host"
    )  # fmt: skip
    cxy: float = param(-0.95, label="Cxy", help="Level coefficient; a mirror's is negative.", cost="host", ge=-4, le=4)
    cz: float = param(0.95, label="Cz", help="Upright coefficient.", cost="host", ge=-4, le=4)
    exponent: float = param(
        20.0, label="Exponent", help="Of the lobe.", cost="host", ge=0, le=1e4, source="Lafortune et al. 1997"
    )

    def reflectance(self, view: np.ndarray, light: np.ndarray) -> np.ndarray:
        """Its value, (..., 3) [sr-1]."""
        colours = np.array(self.diffuse), np.array(self.colour)
        return models.lafortune(view, light, *colours, self.cxy, self.cz, self.exponent)


AnySurface = Validation | Satin | Matte | Metal | PhongLobe | LafortuneLobe


class ReflectanceArguments(Model):
    """A surface, and the directions that are asked for."""

    material: Annotated[AnySurface, Field(discriminator="kind")] = param(
        Matte(),
        label="Material",
        help="A lobe (phong, lafortune) or a built-in table (validation, satin, matte, metal), as its name or with its "
        "parameters; unread where a file is given.",
        cost="host",
    )
    directions: Annotated[tuple[tuple[Polar, Azimuth, Polar, Azimuth], ...], Field(max_length=MOST)] = param(
        MIRRORED,
        label="Directions",
        help="theta_o, phi_o, theta_l, phi_l of each pair, in degrees: view and light, theta from the normal, phi from "
        "the tangent; or the file of that name.",
        cost="host",
    )
    read: Literal["table", "model"] = param(
        "table",
        label="Read",
        help="Whether a built-in table is read between its nodes, as pictures do, or the model that it samples is "
        "asked itself.",
        cost="host",
    )
    albedo: bool = param(True, label="Albedo", help="Whether the albedo of each view is summed.", cost="host")

    @field_validator("material", mode="before")
    @classmethod
    def _by_name(cls, given: Any) -> Any:
        return {"kind": given} if isinstance(given, str) else given


def _surface(given: ReflectanceArguments, files: Mapping[str, Path]) -> tuple[Reflectance, tuple[str, ...]]:
    """The reflectance of pairs of directions (N, 3), and what is to be said of it."""
    if "brdf" in files:
        try:
            table = load_brdf(files["brdf"])
        except InputError as failure:
            raise failure.at("brdf", ("file",)) from None
        return _read(table), (f"file in the coordinates {table.coordinates}", *table.notes)
    surface = given.material
    if isinstance(surface, PhongLobe | LafortuneLobe):
        return surface.reflectance, (f"lobe: {surface.kind}",)
    if given.read == "model":
        if isinstance(surface, Validation):
            return _rule(surface), ("the validation table's rule",)
        return surface.reflectance, (f"model of the table {surface.kind}",)
    table = surface.table()
    shape = " x ".join(str(len(nodes)) for nodes in table.nodes)
    return _read(table), (f"table {surface.kind}, {shape} nodes in the coordinates {table.coordinates}",)


def _read(table: BrdfTable) -> Reflectance:
    return lambda view, light: lookup(table, view, light)


def _rule(surface: Validation) -> Reflectance:
    def found(view: np.ndarray, light: np.ndarray) -> np.ndarray:
        theta = [np.arccos(np.clip(way[:, 2], -1, 1)) for way in (view, light)]
        phi_o, phi_l = (np.arctan2(way[:, 1], way[:, 0]) for way in (view, light))
        return surface.colours((theta[0], phi_o, theta[1], phi_l if surface.azimuths == "both" else phi_l - phi_o))

    return found


def _directions(given: ReflectanceArguments, files: Mapping[str, Path]) -> np.ndarray:
    """Angles (N, 4) in degrees."""
    if "directions" not in files:
        found = np.array(given.directions, np.float64).reshape(-1, 4)
    elif given.directions != MIRRORED:
        raise InputError("directions", "are given both as an argument and as a file", "one of the two")
    else:
        found = read_directions(files["directions"])
    if not len(found):
        raise InputError("directions", "none is given", "theta_o, phi_o, theta_l, phi_l of at least one pair")
    return found


def read_directions(path: Path) -> np.ndarray:
    """Angles (N, 4) in degrees from a file.

    Args:
        path: an .npz with `directions` (N, 4) or with theta_o, phi_o, theta_l, phi_l (N,); or a CSV of these four
            columns, with or without a heading line.

    Raises:
        AssetError: anything else. LimitError: more than `MOST`.
    """
    names = ("theta_o", "phi_o", "theta_l", "phi_l")
    words = "theta_o, phi_o, theta_l, phi_l of each pair, in degrees"
    try:
        if check_file(path, DEFAULT_LIMITS).startswith(b"PK"):
            data = read_npz(path, ("directions", *names), MOST * 32)
            found = data["directions"] if "directions" in data else np.stack([data[name] for name in names], axis=1)
        else:
            rows = list(csv.reader(io.StringIO(path.read_text(encoding="utf-8-sig"))))
            rows = [row for row in rows if row][: MOST + 2]
            heading = bool(rows) and not rows[0][0].strip().lstrip("+-.").replace(".", "", 1).isdigit()
            found = np.array(rows[heading:], np.float64)
        found = np.asarray(found, np.float64)
    except InputError as failure:
        raise failure.at("directions") from None
    except (KeyError, ValueError, UnicodeDecodeError):
        raise AssetError("directions", "hold no such numbers", words) from None
    if found.ndim != 2 or found.shape[1] != 4 or not np.isfinite(found).all():
        raise AssetError("directions", f"are of shape {found.shape}", words)
    if len(found) > MOST:
        raise LimitError("directions", f"are {len(found):,} pairs", f"at most {MOST:,}")
    if (found[:, ::2] < 0).any() or (found[:, ::2] > 90).any():
        raise AssetError("directions", "hold a theta out of range", "0 to 90 degrees from the normal")
    return found


def lights(rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Directions (N, 3) over the hemisphere, and what each counts in an integral of cosine and solid angle (N,).

    Rings by Gauss' rule in the angle from the normal, so that sharp lobes at any height are met alike.
    """
    x, w = np.polynomial.legendre.leggauss(rings)
    theta, weight = (x + 1) * (math.pi / 4), w * (math.pi / 4)
    phi = (np.arange(4 * rings) + 0.5) * (2 * math.pi / (4 * rings))
    grid = np.meshgrid(theta, phi, indexing="ij")
    count = weight * np.cos(theta) * np.sin(theta) * (2 * math.pi / (4 * rings))
    return direction_of(*grid).reshape(-1, 3), np.repeat(count, 4 * rings)


def _albedos(found: Reflectance, views: np.ndarray, progress: Progress) -> tuple[np.ndarray, np.ndarray]:
    """Directional-hemispherical reflectance (V, 3) of views (V, 3), and its difference from a sum of half the rings."""
    sums = []
    for number, view in enumerate(views):
        progress(number / len(views), "albedos")
        pair = []
        for rings in (RINGS, RINGS // 2):
            ways, weights = lights(rings)
            pair.append(weights @ found(np.broadcast_to(view, ways.shape), ways))
        sums.append(pair)
    both = np.array(sums)
    return both[:, 0], np.abs(both[:, 0] - both[:, 1])


def _reflectance(given: ReflectanceArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    found, notes = _surface(given, files)
    degrees = _directions(given, files)
    theta_o, phi_o, theta_l, phi_l = np.radians(degrees).T
    view, light = direction_of(theta_o, phi_o), direction_of(theta_l, phi_l)
    values = found(view, light)
    arrays = {
        "directions_deg": degrees,
        "brdf": values,
        "reciprocity_error": values - found(light, view),
    }
    rng = np.random.default_rng(0)
    z, phi = rng.random((2, PAIRS)), rng.random((2, PAIRS)) * 2 * math.pi
    one, other = (direction_of(np.arccos(z[k]), phi[k]) for k in range(2))
    forth, back = found(one, other), found(other, one)
    worst = float(np.sqrt(((forth - back) ** 2).mean() / max(float((forth**2).mean()), 1e-300)))
    notes = (*notes, f"over {PAIRS:,} random pairs, exchanging view and light changes it by {worst:.2g} (relative rms)")
    if given.albedo:
        unique, which = np.unique(degrees[:, :2], axis=0, return_inverse=True)
        if len(unique) > VIEWS:
            raise LimitError("directions", f"have {len(unique):,} views whose albedo is to be summed",
                             f"at most {VIEWS}, or albedo = false")  # fmt: skip
        albedo, error = _albedos(found, direction_of(*np.radians(unique).T), progress)
        arrays |= {"albedo": albedo[which.ravel()], "albedo_error": error[which.ravel()]}
        most = float(albedo.max())
        notes = (*notes, f"greatest albedo: {most:.4g}" + (", more than arrives" if most > 1 + 1e-3 else ""))
    return Values(arrays, notes)


REFLECTANCE = Quantity(
    title="Reflectance",
    help="What a surface sends of the light from one direction into another, from a measured file, a built-in table or "
    "a lobe; its albedo, and whether light and view may change places.",
    arguments=ReflectanceArguments,
    function=_reflectance,
    units={
        "directions_deg": "degrees; [pair, (theta_o, phi_o, theta_l, phi_l)], view and light, theta from the normal, "
        "phi from the tangent",
        "brdf": "sr-1; [pair, (red, green, blue)], radiance for each unit of irradiance",
        "reciprocity_error": "sr-1; [pair, rgb], the value less that with view and light exchanged",
        "albedo": "1; [pair, rgb], share of the light from the pair's view direction that is sent to the whole "
        "hemisphere, directional-hemispherical",
        "albedo_error": "1; [pair, rgb], difference from a sum over half as many rings",
    },
    technique="tables: bilinear in the light for each neighbouring view node, then in the view (three or five "
    "interpolations); lobes and models in closed form; albedo by Gauss' rule over 64 rings of 256 lights",
    source="Porquet 2005, section 3.3.2.2, with errata 003-4; Matusik et al. 2003; Lafortune & Willems 1994; Lafortune "
    "et al. 1997; Oren & Nayar 1994; Ashikhmin & Shirley 2000; Walter et al. 2007",
    error={
        "brdf": "1e-12 of the interpolation; what a table leaves out between its nodes is its own",
        "albedo": "albedo_error says it of each view",
    },
    files=(
        InputFile("brdf", "a MERL file, or an .npz with brdf and its node angles in degrees"),
        InputFile("directions", "an .npz with directions [pair, 4] or theta_o, phi_o, theta_l and phi_l; or a CSV"),
    ),
)
"""The quantity `reflectance`."""
