"""The quantity `composite`: what rays see of prisms of constant extinction and colour."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import ConfigDict, Field

from renderer.core.errors import AssetError, InputError, LimitError
from renderer.core.params import Model, param, validate
from renderer.core.quantity import InputFile, Progress, Quantity, Values
from renderer.shells.composite import crossings, exact, march, segments
from renderer.world.limits import DEFAULT_LIMITS

MOST = 200_000_000
"""Most tests of a place against a solid: some ten seconds of one core."""

CHUNK = 1024
"""Rays at once."""

Number = Annotated[float, Field(ge=-1e9, le=1e9)]
Vector = tuple[Number, Number, Number]
Extinction = Annotated[float, Field(ge=0, le=1e9)]
Radiance = Annotated[float, Field(ge=0, le=1e9)]


class Material(Model):
    """Even matter."""

    sigma: Extinction
    color: tuple[Radiance, Radiance, Radiance]


class Prism(Model):
    """A solid; what else is said of it, as its planes, is left unread."""

    model_config = ConfigDict(extra="ignore")

    vertices: tuple[Vector, Vector, Vector, Vector, Vector, Vector]
    material: Annotated[int, Field(ge=0, le=9999)] | None = None
    sigma: Extinction | None = None
    color: tuple[Radiance, Radiance, Radiance] | None = None


class Ray(Model):
    """A ray; what else is said of it is left unread."""

    model_config = ConfigDict(extra="ignore")

    o: Vector
    d: Vector


class CompositeArguments(Model):
    """Prisms, rays, and how the light along them is summed."""

    prisms: Annotated[tuple[Prism, ...], Field(max_length=1000)] = param(
        (),
        label="Prisms",
        help="Each with six `vertices` (the base's three, then their displaced copies), and its own `sigma` and "
        "`color`, or the number of its `material`; or the file of that name.",
    )
    rays: Annotated[tuple[Ray, ...], Field(max_length=100_000)] = param(
        (), label="Rays", help="Each with its origin `o` and direction `d`; or the file of that name."
    )
    materials: Annotated[tuple[Material, ...], Field(max_length=1000)] = param(
        (),
        label="Materials",
        help="Each with its extinction `sigma` per metre and its `color`; prism k takes material k, "
        "where it says nothing.",
    )
    set: str = param(
        "", label="Set", help="Which of a file's `sets` is meant, where it has several.", max_length=100
    )
    technique: Literal["exact", "march", "segments"] = param(
        "exact",
        label="Technique",
        help="Closed form between borders; equal steps along the ray, what overlaps added up; equal steps in each "
        "tetrahedron by itself, by their entries, as cells are drawn.",
        cost="host",
        source="Dufort 2005, sections 5.1.1 and 5.1.2",
    )
    steps: int = param(
        10,
        label="Steps",
        help="Along the ray for `march`, in each tetrahedron for `segments`.",
        unit="count",
        cost="host",
        ge=1,
        le=100_000,
        source="Dufort 2005, section 5.1.2",
    )
    opacity_correction: bool = param(
        True,
        label="Opacity correction",
        help="Whether a step hides by its own length, or always as the reference length does.",
        cost="host",
        source="Dufort 2005, section 5.1.2",
    )
    premultiplied: bool = param(
        True,
        label="Premultiplied",
        help="Whether a step's colour counts by its opacity; the sum was printed without.",
        cost="host",
        source="Dufort 2005, equation 5.1",
    )
    reference_length: float = param(
        0.1, label="Reference length", help="Which an uncorrected step counts for.", unit="m", cost="host", gt=0, le=1e6
    )


DOCUMENT = ("materials", "prisms", "rays")
"""What a file may hold besides its sets."""


def read(arguments: CompositeArguments, files: Mapping[str, Path]) -> CompositeArguments:
    """The arguments with what the files hold.

    Raises:
        AssetError: no JSON, or not of such things.
        InputError: something is given twice, or a set is missing.
        LimitError: a file over the size limit.
    """
    given: dict[str, Any] = {}
    for name, path in files.items():
        document = _json(name, path)
        if isinstance(document, list):
            document = {name: document}
        if not isinstance(document, dict):
            raise AssetError(name, "holds no list", "a list, or an object of prisms, rays and materials, or of sets")
        sets = document.get("sets", {})
        if sets and isinstance(sets, dict):
            chosen = arguments.set or (next(iter(sets)) if len(sets) == 1 else "")
            if chosen not in sets:
                raise InputError("set", f"{chosen!r} is not in the file", ", ".join(map(str, sets)))
            document = {**document, **(sets[chosen] if isinstance(sets[chosen], dict) else {})}
        if getattr(arguments, name):
            raise InputError(name, "are given both as an argument and as a file", "one of the two")
        # what an argument or a file of its own name gives goes before what another file holds besides
        taken = {key for key in DOCUMENT if getattr(arguments, key) or key in files or key in given} - {name}
        given |= {key: document[key] for key in DOCUMENT if key in document and key not in taken}
    # what the document says is not gone through again: it is large, and has been checked
    found = validate(CompositeArguments, given)
    return arguments.model_copy(update={key: getattr(found, key) for key in given})


def _json(name: str, path: Path) -> Any:
    try:
        size = path.stat().st_size
        if size > DEFAULT_LIMITS.file_bytes:
            raise LimitError(name, f"the file has {size:,} bytes", f"at most {DEFAULT_LIMITS.file_bytes:,}")
        return json.loads(path.read_text(encoding="utf-8"))
    except OSError as failure:
        raise AssetError(name, f"cannot be read: {failure.strerror}") from None
    except (ValueError, RecursionError):
        raise AssetError(name, "is no JSON text") from None


def _matter(given: CompositeArguments) -> tuple[np.ndarray, np.ndarray]:
    """Extinction (P,) and colour (P, 3) of each prism."""
    extinction, colour = [], []
    for number, prism in enumerate(given.prisms):
        index = number if prism.material is None else prism.material
        of = given.materials[index] if index < len(given.materials) else None
        if (of is None and (prism.sigma is None or prism.color is None)) or (
            of is None and prism.material is not None
        ):
            raise InputError(f"prisms.{number}", "has no material", "its own sigma and color, or one of the materials")
        extinction.append(prism.sigma if prism.sigma is not None else of.sigma if of else 0.0)
        colour.append(prism.color if prism.color is not None else of.color if of else (0.0, 0.0, 0.0))
    return np.array(extinction), np.array(colour)


def _composite(arguments: CompositeArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    given = read(arguments, files)
    for name in ("prisms", "rays"):
        if not getattr(given, name):
            raise InputError(name, "none is given", f"at least one, or the file `{name}`")
    corners = np.array([prism.vertices for prism in given.prisms])
    origins, directions = np.array([ray.o for ray in given.rays]), np.array([ray.d for ray in given.rays])
    norm = np.linalg.norm(directions, axis=1, keepdims=True)
    if not (norm > 0).all():
        raise InputError(f"rays.{int(np.argmin(norm))}.d", "has no direction")
    directions = directions / norm
    extinction, colour = _matter(given)
    count, solids = len(origins), 3 * len(corners)
    places = count * solids * (2 * solids + (0 if given.technique == "exact" else given.steps))
    if places > MOST:
        raise LimitError("rays", f"{places:,} tests of a place against a solid", f"at most {MOST:,}")
    made: list[tuple[np.ndarray, ...]] = []
    for begin in range(0, count, CHUNK):
        progress(begin / count, "rays through prisms")
        found = crossings(corners, origins[begin : begin + CHUNK], directions[begin : begin + CHUNK])
        right = exact(found, extinction, colour)
        rgb, alpha = right
        if given.technique != "exact":
            by = march if given.technique == "march" else segments
            length = None if given.opacity_correction else given.reference_length
            rgb, alpha = by(found, extinction, colour, given.steps, length, given.premultiplied)
        intervals = np.stack([found.first, found.last], axis=2)
        made.append((intervals, found.order, rgb, alpha, rgb - right[0], alpha - right[1]))
    names = ("intervals", "front_to_back", "rgb", "alpha", "rgb_error", "alpha_error")
    arrays = {name: np.concatenate([part[k] for part in made]) for k, name in enumerate(names)}
    worst = max(float(np.abs(arrays[name]).max()) for name in ("rgb_error", "alpha_error"))
    notes = (
        f"technique: {given.technique}" + ("" if given.technique == "exact" else f", {given.steps} steps"),
        f"largest difference from the closed form: {worst:.3g}",
        "black background; directions are made unit; solids behind a ray's origin are not met",
    )
    return Values(arrays, notes)


COMPOSITE = Quantity(
    title="Light through prisms",
    help="What rays see of prisms of constant extinction and colour; where solids overlap, extinctions and emissions "
    "add.",
    arguments=CompositeArguments,
    function=_composite,
    units={
        "intervals": "m along the ray, entry and exit of each prism; [ray, prism, 2], null where it is missed",
        "front_to_back": "numbers of the prisms by their entries; [ray, prism], -1 behind those that are met",
        "rgb": "radiance in the colours' own unit, premultiplied, black background; [ray, 3]",
        "alpha": "1 - transmittance; [ray]",
        "rgb_error, alpha_error": "the technique's difference from the closed form",
    },
    technique="as asked: exact (every tetrahedron's borders from its planes, constant matter between two of them in "
    "closed form), march (equal steps along the ray), segments (equal steps in each tetrahedron, one after the other)",
    source="Dufort 2005, sections 3.1, 5.1.1 and 5.1.2, with errata 002-1 and 002-4",
    error={
        "exact": "1e-13 of the distances and of the sums",
        "march, segments": "rgb_error and alpha_error say it of each ray",
    },
    files=(
        InputFile("prisms", "JSON: a list of prisms, or an object of prisms, materials and rays, or of `sets` of such"),
        InputFile("rays", "JSON: a list of rays, or an object of such"),
    ),
)
"""The quantity `composite`."""
