"""Terrain files: 16-bit PNG and .npz here, GeoTIFF in `terrain_geotiff`. The content decides, not the name."""

from __future__ import annotations

import io
import struct
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from renderer.core.errors import AssetError
from renderer.world.arrays import npz_names, read_npz
from renderer.world.limits import Limits, Unsaid, check_file
from renderer.world.terrain_geotiff import read_geotiff
from renderer.world.terrain_grid import Terrain, TerrainReading, check_shape

PNG_END = b"IEND\xaeB`\x82"
"""The last chunk's name and checksum (PNG 1.2, section 11.2.5). Pixels may be whole without it, and wrong unnoticed."""

FORMATS = "a GeoTIFF, a 16-bit grey PNG, or an .npz with elevation and cell_size"


def terrain_format(head: bytes) -> str | None:
    """`tiff`, `png` or `npz` by the first bytes of a file; None for others."""
    if head[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"):
        return "tiff"
    if head[:8] == b"\x89PNG\r\n\x1a\n":
        return "png"
    return "npz" if head[:4] == b"PK\x03\x04" else None


def read_raster(path: Path, limits: Limits, reading: TerrainReading) -> Terrain:
    """The terrain of a file as it stands, holes as NaN, not yet checked beyond its shape.

    Raises:
        AssetError, LimitError: naming the field, in words.
    """
    kind = terrain_format(check_file(path, limits))
    if kind == "tiff":
        return read_geotiff(path, limits, reading)
    if kind == "png":
        return _read_png(path, limits, reading)
    if kind == "npz":
        return _read_npz(path, limits, reading)
    raise AssetError("file", "is no elevation model that can be read", FORMATS)


def png_header(head: bytes) -> tuple[int, int, int, int]:
    """Width, height, bit depth and colour type that a PNG's first chunk claims (PNG 1.2, section 11.2.2).

    Raises:
        AssetError: cut short within the header.
    """
    if len(head) < 26 or head[12:16] != b"IHDR":
        raise AssetError("file", "is cut short within its PNG header")
    width, height, depth, colour = struct.unpack(">IIBB", head[16:26])
    return width, height, depth, colour


def _read_png(path: Path, limits: Limits, reading: TerrainReading) -> Terrain:
    data = path.read_bytes()
    width, height, depth, colour = png_header(data)
    if (depth, colour) != (16, 0):
        raise AssetError(
            "file",
            f"is a PNG of {depth} bits a channel" + ("" if colour == 0 else " in colour or with a palette"),
            "16-bit grey: 8 bits would make terraces",
        )
    check_shape((height, width), limits)
    if PNG_END not in data[-4096:]:
        raise AssetError("file", "is a PNG cut short before its end")
    if reading.cell_size == (0.0, 0.0):
        raise Unsaid("cell_size", "is not in a PNG, so it must be said", "metres between pixels along x and y")
    if reading.elevation_high <= reading.elevation_low:
        raise Unsaid("elevation_high", "must be said for a PNG and lie above elevation_low", "metres")
    try:
        with Image.open(io.BytesIO(data), formats=["PNG"]) as picture:
            values = np.array(picture)
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as failure:
        raise AssetError("file", "is a damaged or truncated PNG") from failure
    span = reading.elevation_high - reading.elevation_low
    return Terrain(
        (reading.elevation_low + values.astype(np.float64) * (span / 65535)).astype(np.float32), reading.cell_size
    )


def _read_npz(path: Path, limits: Limits, reading: TerrainReading) -> Terrain:
    if "elevation" not in npz_names(path):
        raise AssetError(
            "elevation", "is not among the arrays of the file", "elevation (2D, metres) and cell_size (dx, dy)"
        )
    data = read_npz(path, ("elevation", "cell_size", "latitude", "longitude"), limits.cells * 8)
    elevation = data["elevation"]
    if elevation.dtype.kind not in "iuf":
        raise AssetError("elevation", f"is of type {elevation.dtype}", "real numbers")
    check_shape(elevation.shape, limits)
    if "cell_size" in data:
        cell = _numbers(data["cell_size"], "cell_size", (1, 2))
    elif reading.cell_size != (0.0, 0.0):
        cell = reading.cell_size
    else:
        raise Unsaid(
            "cell_size", "is not among the arrays of the file, so it must be said", "metres between nodes (dx, dy)"
        )
    one = {name: _numbers(data[name], name, (1,))[0] for name in ("latitude", "longitude") if name in data}
    for name, most in (("latitude", 90), ("longitude", 360)):
        if name in one and abs(one[name]) > most:
            raise AssetError(name, f"is {one[name]:g} degrees", f"-{most} to {most}")
    return Terrain(elevation, (cell[0], cell[-1]), latitude=one.get("latitude"), longitude=one.get("longitude"))


def _numbers(array: np.ndarray, name: str, counts: tuple[int, ...]) -> tuple[float, ...]:
    """The finite numbers of a small array of the file."""
    if array.dtype.kind not in "iuf" or array.size not in counts or not np.isfinite(array).all():
        raise AssetError(
            name,
            f"has shape {array.shape} and type {array.dtype}",
            "finite numbers: " + " or ".join(str(count) for count in counts),
        )
    return tuple(float(value) for value in array.ravel())


def save_npz(path: Path, terrain: Terrain) -> None:
    """Write a terrain as .npz: `elevation`, `cell_size`, and `latitude`, `longitude` of the centre where known."""
    place: dict[str, Any] = (
        {}
        if terrain.latitude is None or terrain.longitude is None
        else {"latitude": np.float64(terrain.latitude), "longitude": np.float64(terrain.longitude)}
    )
    with path.open("wb") as stream:
        np.savez(stream, elevation=terrain.elevation, cell_size=np.array(terrain.cell_size, dtype=np.float64), **place)
