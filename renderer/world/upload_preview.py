"""What a file holds, in JSON values that a person can check before it replaces anything."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from renderer.core.errors import InputError
from renderer.core.params import validate
from renderer.world.arrays import npz_names
from renderer.world.brdf import AXES
from renderer.world.brdf_files import load_brdf
from renderer.world.image_files import load_image
from renderer.world.limits import Limits, Unsaid
from renderer.world.maps import QUANTITIES, load_map
from renderer.world.mesh import MeshReading, load_mesh
from renderer.world.points import PointsReading, load_points
from renderer.world.terrain import TerrainReading, load_terrain
from renderer.world.volume import VolumeReading, load_volume

Preview = dict[str, Any]


def terrain(path: Path, limits: Limits, reading: Mapping[str, Any]) -> Preview:
    """Nodes, cells, extent and heights of a terrain.

    Where its format has no place for cells or heights and nobody said them yet: the nodes, and what is to be said.
    """
    try:
        land = load_terrain(path, limits, validate(TerrainReading, dict(reading)))
    except Unsaid as unsaid:
        if reading:
            raise
        stand_in = TerrainReading(cell_size=(1.0, 1.0), elevation_low=0.0, elevation_high=1.0)
        nodes = load_terrain(path, limits, stand_in).elevation.shape
        return {"rows": nodes[0], "columns": nodes[1], "still_to_say": _terrain_fields(unsaid)}
    rows, columns = land.elevation.shape
    return {
        "rows": rows,
        "columns": columns,
        "units": "m",
        "cell_size": list(land.cell_size),
        "extent": list(land.size),
        "elevation": {"lowest": float(land.elevation.min()), "highest": float(land.elevation.max())},
        "latitude": land.latitude,
        "longitude": land.longitude,
        "coordinate_system": f"EPSG:{land.crs.epsg}" if land.crs and land.crs.epsg else "",
        "notes": "; ".join(land.notes),
    }


def _terrain_fields(unsaid: Unsaid) -> str:
    """Fields of the reading to be filled in; only a picture leaves its heights unsaid too."""
    return "cell_size, elevation_low, elevation_high" if "PNG" in unsaid.message else unsaid.field


def mesh(path: Path, limits: Limits, reading: Mapping[str, Any]) -> Preview:
    """Counts, extent and closedness of a mesh."""
    body = load_mesh(path, limits, validate(MeshReading, dict(reading)))
    low, high = body.bounds
    return {
        "faces": len(body.faces),
        "vertices": len(body.vertices),
        "units": "m",
        "extent": [float(length) for length in high - low],
        "lowest_corner": [float(value) for value in low],
        "watertight": body.watertight,
        "two_sided": body.two_sided,
        "texture_coordinates": body.corner_uv is not None,
        "notes": "; ".join(body.notes),
    }


def volume(path: Path, limits: Limits, reading: Mapping[str, Any]) -> Preview:
    """Voxels, extent and opacity of a volume, or what is still to be said about it."""
    try:
        box = load_volume(path, limits, validate(VolumeReading, dict(reading)))
    except Unsaid as unsaid:
        if reading:
            raise
        shape = load_volume(path, limits, VolumeReading(reference_length=1.0)).rgba.shape
        return {"voxels": list(shape[2::-1]), "still_to_say": unsaid.field}
    return {
        "voxels": list(box.rgba.shape[2::-1]),
        "units": "m",
        "extent": list(box.size),
        "reference_length": box.reference_length,
        "filled": float((box.rgba[..., 3] > 0).mean()),
        "notes": "; ".join(box.notes),
    }


def image(path: Path, limits: Limits, reading: Mapping[str, Any]) -> Preview:
    """Pixels and range of a picture; it has nothing to be said."""
    if reading:
        raise InputError(next(iter(reading)), "is not a parameter: a picture leaves nothing unsaid")
    picture = load_image(path, limits)
    return {
        "width": picture.shape[1],
        "height": picture.shape[0],
        "linear_values": {"lowest": float(picture[..., :3].min()), "highest": float(picture[..., :3].max())},
    }


def quantity(path: Path, limits: Limits, reading: Mapping[str, Any]) -> Preview:
    """Extent in values and range of a map of one quantity; it has nothing to be said."""
    if reading:
        raise InputError(next(iter(reading)), "is not a parameter: a map leaves nothing unsaid")
    name = next(name for name in QUANTITIES if name in npz_names(path))
    values, full = load_map(path, name, limits)
    return {
        "quantity": name,
        "rows": values.shape[0],
        "columns": values.shape[1],
        "values": {"lowest": float(values.min()), "highest": float(values.max()), "full": full},
    }


def brdf(path: Path, limits: Limits, reading: Mapping[str, Any]) -> Preview:
    """Directions and range of a tabulated reflectance; it has nothing to be said."""
    if reading:
        raise InputError(next(iter(reading)), "is not a parameter: a reflectance leaves nothing unsaid")
    table = load_brdf(path, limits)
    return {
        "coordinates": ", ".join(name for name in AXES[table.coordinates] if name),
        "directions": [len(nodes) for nodes, name in zip(table.nodes, AXES[table.coordinates]) if name],
        "units": "sr-1",
        "values": {"lowest": float(table.values.min()), "highest": float(table.values.max())},
        "notes": "; ".join(table.notes),
    }


def points(path: Path, limits: Limits, reading: Mapping[str, Any]) -> Preview:
    """Count and extent of a cloud, and what its points have beside a place."""
    cloud = load_points(path, limits, validate(PointsReading, dict(reading)))
    return {
        "points": len(cloud.position),
        "units": "m",
        "extent": [float(length) for length in np.ptp(cloud.position, axis=0)],
        "lowest_corner": [float(value) for value in cloud.position.min(axis=0)],
        "normals": cloud.normal is not None,
        "colours": cloud.colour is not None,
        "notes": "; ".join(cloud.notes),
    }


PREVIEWS: dict[str, Callable[[Path, Limits, Mapping[str, Any]], Preview]] = {
    "terrain": terrain,
    "mesh": mesh,
    "volume": volume,
    "image": image,
    "map": quantity,
    "brdf": brdf,
    "points": points,
}
"""One loader a kind; `upload.Kind` names the same."""
