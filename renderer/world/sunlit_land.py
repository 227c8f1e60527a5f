"""The land of a sun study: its ground, what stands on it, and where on Earth it lies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from renderer.core.errors import AssetError, InputError
from renderer.world.sun_course import Place, SunlightPeriod
from renderer.world.sunlight import COVERED
from renderer.world.terrain import Terrain, default_terrain, load_terrain
from renderer.world.terrain_crs import north_of

FILES = ("terrain", "canopy")


@dataclass(frozen=True)
class Land:
    """What is lit.

    Attributes:
        terrain: its ground, m above the sea, with its place on Earth.
        surface: (rows, columns) m above the sea: what hides the sun, the ground with the trees on it.
    """

    terrain: Terrain
    surface: np.ndarray

    @property
    def wooded(self) -> bool:
        """Whether anything stands on the ground."""
        return bool((self.surface > self.terrain.elevation).any())

    @property
    def closed(self) -> bool:
        """Whether no ground is left between the trees."""
        return bool((self.surface - self.terrain.elevation > COVERED).all())


def land_of(terrain: Terrain, canopy: np.ndarray | None = None) -> Land:
    """A land of a user's own.

    Args:
        terrain: its ground.
        canopy: (rows, columns) heights over the ground, m; nothing below 0 counts.

    Raises:
        AssetError: the canopy has other nodes than the terrain.
    """
    if canopy is None:
        return Land(terrain, terrain.elevation)
    if canopy.shape != terrain.elevation.shape:
        raise AssetError("canopy", f"has shape {canopy.shape}", f"{terrain.elevation.shape}, the terrain's")
    return Land(terrain, terrain.elevation + np.maximum(canopy, 0).astype(np.float32))


def land_of_files(files: Mapping[str, Path]) -> Land:
    """The land of an elevation model, `terrain`, and of a raster of canopy heights on the same nodes, `canopy`.

    Raises:
        InputError: a file of another name, or a canopy on no terrain.
        AssetError, LimitError: what is wrong with a file, in words.
    """
    for name in files:
        if name not in FILES:
            raise InputError(name, "is no file of a land", " and ".join(FILES))
    if "canopy" in files and "terrain" not in files:
        raise InputError("canopy", "stands on no terrain", "the terrain that it belongs to")
    try:
        terrain = load_terrain(files["terrain"]) if "terrain" in files else default_terrain()
    except InputError as failure:
        raise failure.at("terrain") from None
    if "canopy" not in files:
        return land_of(terrain)
    try:
        return land_of(terrain, load_terrain(files["canopy"]).elevation)
    except InputError as failure:
        raise failure.at("canopy") from None


def check_receiver(receiver: str, land: Land) -> None:
    """Refuse a study of nothing.

    Raises:
        InputError: of the tops of trees where none stand, or of ground that trees cover wholly.
    """
    if receiver == "canopy" and not land.wooded:
        raise InputError("receiver", "is the canopy, but no tree stands on this land", "ground, or bare_ground")
    if receiver == "ground" and land.closed:
        raise InputError("receiver", "is the ground, but trees cover all of it", "canopy, or bare_ground")


def place_of(period: SunlightPeriod, land: Land) -> Place:
    """Where the sun of a study stands over its land.

    Raises:
        InputError: neither the land nor the study says where it lies.
    """
    terrain = land.terrain
    found = {}
    for name in ("latitude", "longitude"):
        said = getattr(period, name)
        found[name] = said if said is not None else getattr(terrain, name)
        if found[name] is None:
            raise InputError(name, "is not in the land's file, so it must be said", "degrees")
    low, high = (float(np.clip(edge(terrain.elevation), -500, 9000)) for edge in (np.min, np.max))
    rows, columns = terrain.elevation.shape
    bearing = 0.0
    if terrain.crs is not None:
        step = [cell / unit for cell, unit in zip(terrain.cell_size, terrain.crs.unit, strict=True)]
        centre = (terrain.origin[0] + (columns - 1) / 2 * step[0], terrain.origin[1] - (rows - 1) / 2 * step[1])
        bearing = north_of(terrain.crs, *centre)
    return Place(float(found["latitude"]), float(found["longitude"]), bearing, (low, high))
