"""The quantities that can be measured: what each needs, how it is found, and how far off it may be."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from renderer.core import registry
from renderer.core.errors import AssetError, InputError, LimitError
from renderer.core.params import Model, param
from renderer.core.quantity import InputFile, Progress, Quantity, Values
from renderer.reference.horizon import horizon
from renderer.study.sunlight import SunlightArguments, sunlight
from renderer.world import sun as suns
from renderer.world.arrays import read_npz
from renderer.world.limits import DEFAULT_LIMITS
from renderer.world.terrain import Terrain, default_terrain, load_terrain

RAYS = 4_000_000
"""Most horizons asked for at once: some minutes on one core over a large grid."""

Index = Annotated[float, Field(ge=0, le=1e6)]


class HorizonArguments(Model):
    """What the horizon of a terrain is asked for."""

    points: Annotated[tuple[tuple[Index, Index], ...], Field(max_length=100_000)] = param(
        (), label="Points", help="Row and column of each eye, row 0 at the northern edge; or the file `points`."
    )
    azimuths: int = param(
        16,
        label="Azimuths",
        help="Number of directions, evenly spread over the circle.",
        unit="count",
        cost="host",
        ge=1,
        le=3600,
    )
    first: float = param(
        0.0,
        label="First azimuth",
        help="The first direction, clockwise from north.",
        unit="deg",
        cost="host",
        ge=-360,
        le=360,
    )


def _horizon(arguments: HorizonArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    terrain = load_terrain(files["terrain"]) if "terrain" in files else default_terrain()
    if "points" in files:
        if arguments.points:
            raise InputError("points", "are given both as an argument and as a file", "one of the two")
        points = read_points(files["points"])
    else:
        points = np.array(arguments.points, np.float64).reshape(-1, 2)
    if not len(points):
        raise InputError("points", "no point is given", "row and column of at least one eye")
    if len(points) * arguments.azimuths > RAYS:
        raise LimitError(
            "points", f"{len(points):,} points in {arguments.azimuths} azimuths", f"at most {RAYS:,} in all"
        )
    azimuths = np.radians(arguments.first) + np.arange(arguments.azimuths) * (2 * np.pi / arguments.azimuths)
    elevation, distance = horizon(terrain.elevation, terrain.cell_size, points, azimuths, progress)
    return Values(
        {"elevation_rad": elevation, "distance_m": distance, "azimuth_rad": azimuths % (2 * np.pi), "row_col": points},
        _terrain_notes(terrain, "terrain" in files),
    )


def _terrain_notes(terrain: Terrain, given: bool) -> tuple[str, ...]:
    rows, columns = terrain.elevation.shape
    which = "the file's" if given else "the default"
    return (
        f"{which} elevation model, {rows} x {columns} nodes, cells of {terrain.cell_size[0]:g} x "
        f"{terrain.cell_size[1]:g} m, bilinear between nodes, nothing beyond its edge, flat Earth",
        *terrain.notes,
    )


def read_points(path: Path) -> np.ndarray:
    """Rows and columns from a file.

    Args:
        path: an `.npz` with `row_col` (P, 2) or `row` and `col` (P,), or a CSV of two columns, row and column, with or
            without a heading line.

    Returns:
        (P, 2) float64.

    Raises:
        AssetError: anything else.
        LimitError: a file over the size limit.
    """
    try:
        size = path.stat().st_size
    except OSError as failure:
        raise AssetError("points", f"cannot be read: {failure.strerror}") from None
    if size > DEFAULT_LIMITS.file_bytes:
        raise LimitError("points", f"the file has {size:,} bytes", f"at most {DEFAULT_LIMITS.file_bytes:,}")
    with path.open("rb") as file:
        packed = file.read(4) == b"PK\x03\x04"
    found = _points_npz(path) if packed else _points_csv(path)
    if found.ndim != 2 or found.shape[1] != 2 or not np.isfinite(found).all():
        raise AssetError("points", "are not pairs of finite numbers", "row and column of each point")
    return found


def _points_npz(path: Path) -> np.ndarray:
    try:
        # A few megabytes of file may hold gigabytes of array: no more is unpacked than may be asked for at once.
        data = read_npz(path, ("row_col", "row", "col"), RAYS * 16)
        if "row_col" in data:
            return np.asarray(data["row_col"], np.float64)
        return np.stack([np.asarray(data["row"], np.float64), np.asarray(data["col"], np.float64)], axis=1)
    except InputError as failure:
        raise failure.at("points") from None
    except (KeyError, ValueError):
        raise AssetError("points", "the .npz holds no points", "row_col (P, 2), or row and col (P,)") from None


def _points_csv(path: Path) -> np.ndarray:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise AssetError("points", "is neither an .npz nor text") from None
    rows = []
    for number, line in enumerate(csv.reader(io.StringIO(text)), start=1):
        cells = [cell.strip() for cell in line]
        if not any(cells) or (number == 1 and cells == ["row", "col"]):
            continue
        try:
            rows.append((float(cells[0]), float(cells[1])))
        except (ValueError, IndexError):
            raise AssetError("points", f"line {number} is not a row and a column", "two numbers, as 12,34") from None
    return np.array(rows, np.float64).reshape(-1, 2)


def _sun(arguments: suns.SunMoment, files: Mapping[str, Path], progress: Progress) -> Values:
    azimuth, elevation = suns.angles(arguments)
    day = suns.day(arguments)
    words = {"up": "the sun does not set that day", "down": "the sun does not rise that day", "": ""}[day.always]
    events = [f"{name} {when.isoformat()}" for name, when in (("sunrise", day.sunrise), ("sunset", day.sunset)) if when]
    return Values(
        {
            "azimuth_rad": np.array(azimuth),
            "elevation_rad": np.array(elevation),
            "direction": suns.direction(arguments),
            "day_seconds": day.seconds,
            "day_azimuth_rad": day.azimuth,
            "day_elevation_rad": day.elevation,
        },
        tuple(note for note in (words, *events) if note),
    )


def _sunlight(arguments: SunlightArguments, files: Mapping[str, Path], progress: Progress) -> Values:
    return Values(*sunlight(arguments, files, progress))


TRUNK: dict[str, Quantity] = {
    "horizon": Quantity(
        title="Horizon",
        help="Exact elevation angle and distance of the terrain's horizon, seen from points on it.",
        arguments=HorizonArguments,
        function=_horizon,
        units={
            "elevation_rad": "rad, above the horizontal, not clamped at 0",
            "distance_m": "m, horizontal; 0 = own slope",
            "azimuth_rad": "rad, clockwise from north",
            "row_col": "grid units",
        },
        technique="closed-form maximum of the slope over every bilinear cell that the ray crosses",
        source="formulas of Dozier, Bruno and Downey 1981 for the horizon, evaluated without their line sampling",
        error={
            "elevation_rad": "1e-9 rad for the bilinear surface (rounding)",
            "distance_m": "1e-6 m; where two places tie within rounding, the nearer one",
        },
        files=(
            InputFile("terrain", "elevation model: GeoTIFF, 16-bit PNG or .npz; the default one when left out"),
            InputFile("points", "row and column of the eyes: .npz or CSV"),
        ),
    ),
    "sun": Quantity(
        title="Sun",
        help="Where the sun stands at a date, a time and a place, and its path over that day.",
        arguments=suns.SunMoment,
        function=_sun,
        units={
            "azimuth_rad": "rad, clockwise from north",
            "elevation_rad": "rad, apparent (refracted)",
            "direction": "unit vector: x east, y north, z up",
            "day_seconds": "s since local midnight",
            "day_azimuth_rad": "rad",
            "day_elevation_rad": "rad, apparent",
        },
        technique="Solar Position Algorithm with atmospheric refraction",
        source="Reda and Andreas 2004, NREL/TP-560-34302, as pvlib carries it",
        error={
            "azimuth_rad": "5.2e-6 rad (0.0003 degrees, Reda and Andreas 2004)",
            "elevation_rad": "5.2e-6 rad above 10 degrees; near the horizon the weather's refraction, up to 3e-3 rad",
        },
    ),
    "sunlight": Quantity(
        title="Sunlight",
        help="Hours of direct sun and irradiation of land over a range of days, under a cloudless sky.",
        arguments=SunlightArguments,
        function=_sunlight,
        units={
            "hours": "h of direct sun",
            "insolation": "kWh m-2 on the ground's own slope, by beam and sky",
            "diffuse": "kWh m-2, the sky's part of it",
            "sky": "share of an even sky's light that arrives",
            "row_col": "grid units",
        },
        technique="horizon of every node along each degree of azimuth, the range's suns counted above it",
        source="Dozier and Frew 1990 (sky); Reda and Andreas 2004 (sun); Ineichen and Perez 2002 (clear sky)",
        error={
            "hours": "0.1 % of a year, 1 % of a month in a steep hollow, against a ray for each sun",
            "insolation": "1.2 % against the same; what a real sky sends is another matter",
            "diffuse": "0.4 %, the same",
            "sky": "0.4 %, the same",
        },
        files=(
            InputFile("terrain", "elevation model: GeoTIFF, 16-bit PNG or .npz; the default one when left out"),
            InputFile("canopy", "heights of trees over it on the same nodes, m: the same formats"),
        ),
    ),
}


def known() -> dict[str, Quantity]:
    """Every quantity by name: those of the trunk, and what each phenomenon adds."""
    return {**TRUNK, **registry.quantities()}
