"""GeoTIFF in and out (OGC 19-008r4, GeoTIFF 1.1): elevation, cell size in metres, place, holes.

Sections cited are those of the standard. North-up and south-up grids are read; rotated ones are refused.
"""

from __future__ import annotations

import logging
import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import tifffile

from renderer.core.errors import AssetError, InputError
from renderer.world.limits import Limits, Unsaid
from renderer.world.terrain_crs import WEB_MERCATOR, Crs, metres_per_degree, place
from renderer.world.terrain_grid import Terrain, TerrainReading, check_shape

PIXEL_SCALE, TIEPOINT, TRANSFORMATION, GEO_KEYS, GEO_DOUBLES, GEO_ASCII = 33550, 33922, 34264, 34735, 34736, 34737
GDAL_METADATA, GDAL_NODATA = 42112, 42113

MODEL_TYPE, RASTER_TYPE, GEODETIC_CRS, ANGULAR_UNIT, PROJECTED_CRS, LINEAR_UNIT, VERTICAL_UNIT = (
    1024,
    1025,
    2048,
    2054,
    3072,
    3076,
    4099,
)
USER_DEFINED = 32767

LENGTHS = {9001: 1.0, 9002: 0.3048, 9003: 1200 / 3937}
"""Metre, international foot, US survey foot, by EPSG unit code."""

SMALLEST_METRE_STEP = 0.05
"""Without a coordinate system a pixel scale below this is read as degrees that nobody declared, and refused."""

# tifffile writes a line for every oddity of a stranger's file; the error that follows says it in words.
logging.getLogger("tifffile").setLevel(logging.CRITICAL)


@dataclass(frozen=True)
class _Grid:
    """Where the nodes are: x, y of node (0, 0), signed steps along columns and rows, in units of the file."""

    origin: tuple[float, float]
    step: tuple[float, float]


def read_geotiff(path: Path, limits: Limits, reading: TerrainReading) -> Terrain:
    """The terrain of a GeoTIFF; declared no-data values become NaN.

    Raises:
        AssetError: naming `file`, `elevation` or `cell_size`.
        LimitError: more nodes than the limit, before any is decoded.
    """
    try:
        with tifffile.TiffFile(path) as file:
            page = file.pages.first
            values = _decode(page, path.stat().st_size, limits)
            tags = {
                code: page.tags[code].value
                for code in (
                    PIXEL_SCALE,
                    TIEPOINT,
                    TRANSFORMATION,
                    GEO_KEYS,
                    GEO_DOUBLES,
                    GEO_ASCII,
                    GDAL_METADATA,
                    GDAL_NODATA,
                )
                if code in page.tags
            }
    except InputError:
        raise
    except Exception as failure:  # tifffile and its codecs raise whatever a damaged file leads them to
        raise AssetError("file", "is a damaged or truncated TIFF") from failure
    keys = _geo_keys(tags.get(GEO_KEYS))
    elevation, notes = _metres(values, tags, keys)
    grid = _grid(tags, keys)
    if grid is None:
        if reading.cell_size == (0.0, 0.0):
            raise Unsaid("cell_size", "is not in the file, so it must be said", "metres between nodes along x and y")
        return Terrain(elevation, reading.cell_size, notes=(*notes, "the TIFF has no place on Earth"))
    if grid.step[1] > 0:  # rows run north: turn the grid over so that row 0 is the northern edge
        elevation = elevation[::-1]
        grid = _Grid(
            (grid.origin[0], grid.origin[1] + (len(elevation) - 1) * grid.step[1]), (grid.step[0], -grid.step[1])
        )
    centre = (
        grid.origin[0] + 0.5 * (elevation.shape[1] - 1) * grid.step[0],
        grid.origin[1] + 0.5 * (len(elevation) - 1) * grid.step[1],
    )
    crs, assumed = _crs(tags, keys, centre, grid.step)
    cell = (grid.step[0] * crs.unit[0], -grid.step[1] * crs.unit[1])
    return Terrain(elevation, cell, grid.origin, crs, notes=(*notes, *assumed))


def _decode(page: Any, file_bytes: int, limits: Limits) -> np.ndarray:
    """The first picture's samples, once its shape, type and extent in the file are believed."""
    shape = tuple(int(length) for length in page.shape)
    if len(shape) == 3 and 1 in (shape[0], shape[2]):
        shape = tuple(length for length in shape if length != 1) or shape
    if len(shape) == 3:
        raise AssetError("elevation", f"has {page.samplesperpixel} bands", "one band of elevations")
    check_shape(shape, limits)
    if page.dtype is None or page.dtype.kind not in "iuf":
        raise AssetError("elevation", "is of a type that is no real number", "8 to 64-bit integers or floats")
    for offset, count in zip(page.dataoffsets, page.databytecounts, strict=True):
        if count == 0 or offset + count > file_bytes:
            raise AssetError("file", "is cut short: part of the elevations is missing")
    decoded: np.ndarray = page.asarray(maxworkers=1)
    return decoded.reshape(shape)


def _metres(values: np.ndarray, tags: dict[int, Any], keys: dict[int, int]) -> tuple[np.ndarray, tuple[str, ...]]:
    """Elevations in metres, holes as NaN, and notes on what was converted."""
    elevation = values.astype(np.float32)
    notes: tuple[str, ...] = ()
    text = str(tags.get(GDAL_NODATA, "")).strip(" \0")
    if text:
        try:
            nodata = float(text)
        except ValueError as failure:
            raise AssetError("elevation", "has a no-data value that is no number") from failure
        # The text carries the value at the type of the file: -3.4028235e38 must meet the float32 it was written from.
        elevation[
            values == np.asarray(nodata).astype(values.dtype)
            if _fits(nodata, values.dtype)
            else np.zeros(values.shape, bool)
        ] = np.nan
    metadata = str(tags.get(GDAL_METADATA, ""))[:20_000]
    scale, offset = (_gdal_number(metadata, role) for role in ("scale", "offset"))
    if scale is not None or offset is not None:
        elevation = elevation * np.float32(1.0 if scale is None else scale) + np.float32(offset or 0.0)
        notes += ("the file's own scale and offset were applied",)
    unit = LENGTHS.get(keys.get(VERTICAL_UNIT, 9001))
    if unit is None:
        raise AssetError(
            "elevation", f"is in the vertical unit EPSG:{keys[VERTICAL_UNIT]}", "metres, feet or US survey feet"
        )
    if unit != 1.0:
        elevation = elevation * np.float32(unit)
        notes += ("elevations were converted from feet",)
    return elevation, notes


def _fits(value: float, dtype: np.dtype[Any]) -> bool:
    """Whether `value` can occur among numbers of `dtype`."""
    if dtype.kind == "f":
        return True
    info = np.iinfo(dtype)
    return math.isfinite(value) and info.min <= value <= info.max


def _gdal_number(metadata: str, role: str) -> float | None:
    """Scale or offset from GDAL's metadata text; read as text, for no stranger's XML is parsed here."""
    found = re.search(rf'<Item [^>]*role="{role}"[^>]*>\s*([-+0-9.eE]{{1,32}})\s*</Item>', metadata)
    try:
        return float(found.group(1)) if found else None
    except ValueError as failure:
        raise AssetError("elevation", f"has a {role} that is no number") from failure


def _geo_keys(directory: Any) -> dict[int, int]:
    """The keys of section 7.1.2 whose value is a short; those held elsewhere (citations, parameters) are not needed."""
    flat = [int(value) for value in directory] if directory is not None and np.iterable(directory) else []
    return {flat[i]: flat[i + 3] for i in range(4, len(flat) - 3, 4) if flat[i + 1] == 0}


def _floats(tags: dict[int, Any], code: int, least: int) -> list[float] | None:
    value = tags.get(code)
    if value is None:
        return None
    numbers = [float(item) for item in np.ravel(value)]
    if len(numbers) < least or not all(math.isfinite(number) for number in numbers):
        raise AssetError("cell_size", "cannot be read from the file's georeference", "finite numbers")
    return numbers


def _grid(tags: dict[int, Any], keys: dict[int, int]) -> _Grid | None:
    """Origin and steps of the nodes (sections 7.1.1, 7.3); None where the file has none."""
    scale, tie, matrix = _floats(tags, PIXEL_SCALE, 2), _floats(tags, TIEPOINT, 6), _floats(tags, TRANSFORMATION, 16)
    if matrix is not None:
        if max(abs(matrix[1]), abs(matrix[4])) > 1e-9 * max(abs(matrix[0]), abs(matrix[5])):
            raise AssetError(
                "cell_size", "is that of a rotated grid", "a grid along its coordinate axes; resample it first"
            )
        step, corner = (matrix[0], matrix[5]), (matrix[3], matrix[7])
    elif scale is not None:
        step = (scale[0], -scale[1])  # row numbers grow southwards (section 7.1.1, ModelPixelScale)
        corner = (tie[3] - tie[0] * step[0], tie[4] - tie[1] * step[1]) if tie else (0.0, 0.0)
    else:
        return None
    if step[0] <= 0 or step[1] == 0:
        raise AssetError("cell_size", f"is ({step[0]:g}, {step[1]:g}) in the file", "more than 0")
    # Samples of an area sit at its centre, half a step in; RasterPixelIsArea (1) is the default (section 7.2.2.2).
    half = 0.0 if keys.get(RASTER_TYPE, 1) == 2 else 0.5
    return _Grid((corner[0] + half * step[0], corner[1] + half * step[1]), step)


def _crs(
    tags: dict[int, Any], keys: dict[int, int], centre: tuple[float, float], step: tuple[float, float]
) -> tuple[Crs, tuple[str, ...]]:
    """The coordinate system, with metres per unit at `centre`, and notes on what was assumed."""
    kept = tuple(
        (code, kind, tags[code])
        for code, kind in ((GEO_KEYS, "H"), (GEO_DOUBLES, "d"), (GEO_ASCII, "s"))
        if code in tags
    )
    if not keys:
        if min(abs(step[0]), abs(step[1])) < SMALLEST_METRE_STEP:
            raise AssetError(
                "cell_size",
                f"is {abs(step[0]):g} in a unit that the file does not name",
                "a GeoTIFF with its coordinate system, or cell_size in metres",
            )
        return Crs(None, False), ("no coordinate system in the file: its pixel scale was taken as metres",)
    if keys.get(MODEL_TYPE) == 2:
        if keys.get(ANGULAR_UNIT, 9102) != 9102:
            raise AssetError("cell_size", f"is in the angular unit EPSG:{keys[ANGULAR_UNIT]}", "degrees")
        if abs(centre[1]) > 89:
            raise AssetError("cell_size", f"cannot be measured at latitude {centre[1]:g}", "-89 to 89 degrees")
        epsg = keys.get(GEODETIC_CRS)
        return (
            Crs(None if epsg == USER_DEFINED else epsg, True, metres_per_degree(centre[1]), kept),
            ("cells were measured in metres at the latitude of the centre",),
        )
    unit = LENGTHS.get(keys.get(LINEAR_UNIT, 9001))
    if unit is None:
        raise AssetError("cell_size", f"is in the unit EPSG:{keys[LINEAR_UNIT]}", "metres, feet or US survey feet")
    epsg = keys.get(PROJECTED_CRS)
    crs = Crs(None if epsg == USER_DEFINED else epsg, False, (unit, unit), kept)
    if epsg == WEB_MERCATOR:
        spot = place(crs, *centre)
        true = math.cos(math.radians(spot[0])) if spot else 1.0  # its metres are stretched by 1 / cos(latitude)
        return Crs(epsg, False, (true, true), kept), (
            "Web Mercator's stretch was undone at the latitude of the centre",
        )
    return crs, ()


def save_geotiff(path: Path | BinaryIO, values: np.ndarray, terrain: Terrain) -> None:
    """Write an array on a terrain's grid as GeoTIFF, in the coordinate system that the terrain came with.

    Args:
        path: the file to write, or where its bytes go.
        values: (rows, columns) of the terrain, as its elevation or hours of sun; NaN where there is none.
        terrain: gives cells, origin and coordinate system; without one, pixels are metres without a place.

    Raises:
        AssetError: `values` is not of the terrain's shape.
    """
    if values.shape != terrain.elevation.shape:
        raise AssetError("elevation", f"has shape {values.shape}", f"{terrain.elevation.shape}, the terrain's")
    crs = terrain.crs or Crs(None, False)
    step = (terrain.cell_size[0] / crs.unit[0], terrain.cell_size[1] / crs.unit[1])
    keys: tuple[tuple[int, str, Any], ...] = crs.tags
    if not keys and crs.epsg is not None:
        entries = [
            (MODEL_TYPE, 2 if crs.geographic else 1),
            (RASTER_TYPE, 2),
            (GEODETIC_CRS if crs.geographic else PROJECTED_CRS, crs.epsg),
        ]
        keys = (
            (GEO_KEYS, "H", (1, 1, 0, len(entries), *(item for key, value in entries for item in (key, 0, 1, value)))),
        )
    half = 0.5 if crs.tags and _geo_keys(crs.tags[0][2]).get(RASTER_TYPE, 1) != 2 else 0.0
    tie = (half, half, 0.0, *terrain.origin, 0.0)
    extra: list[tuple[int, str, int, Any, bool]] = [
        (PIXEL_SCALE, "d", 3, (*step, 0.0), True),
        (TIEPOINT, "d", 6, tie, True),
    ]
    extra += [(code, kind, 0 if kind == "s" else len(value), value, True) for code, kind, value in keys]
    extra.append((GDAL_NODATA, "s", 0, "nan", True))
    tifffile.imwrite(
        path,
        np.asarray(values, dtype=np.float32),
        photometric="minisblack",
        compression="zlib",
        predictor=True,
        extratags=extra,
        metadata=None,
    )
