"""Hours of sun and irradiation at points of a land, as a measurable quantity."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from renderer.core.errors import InputError, LimitError
from renderer.core.params import param
from renderer.world.sun_course import SunlightPeriod, course
from renderer.world.sunlight import Light
from renderer.world.sunlit_land import Land, check_receiver, land_of_files, place_of

NODES = 200_000
"""Most nodes at once, some twenty seconds of a year; more are a sun study's."""

Index = Annotated[int, Field(ge=0, le=1_000_000)]


class SunlightArguments(SunlightPeriod):
    """What the sun of some nodes is asked for."""

    points: Annotated[tuple[tuple[Index, Index], ...], Field(max_length=100_000)] = param(
        (), label="Points", help="Row and column of each node, row 0 at the northern edge; all nodes when left out."
    )


def sunlight(
    arguments: SunlightArguments, files: Mapping[str, Path], progress: Callable[[float, str], None]
) -> tuple[dict[str, np.ndarray], tuple[str, ...]]:
    """Light of the nodes that are asked for, and what was assumed.

    Args:
        arguments: of the range and the nodes.
        files: `terrain` and `canopy`.
        progress: told the share done; may raise `Cancelled`.

    Returns:
        `hours`, `insolation`, `diffuse` and `sky` of each node, (N,) or (rows, columns), and `row_col`; notes.

    Raises:
        InputError, LimitError: naming the argument.
    """
    land = land_of_files(files)
    shape = land.terrain.elevation.shape
    nodes = _nodes(arguments, shape)
    check_receiver(arguments.receiver, land)
    place = place_of(arguments, land)
    suns = course(arguments, place)
    light = Light(
        land.terrain.elevation, land.surface, land.terrain.cell_size, suns, place.altitudes, arguments.receiver
    )
    hours, beam, diffuse, sky = light.at(nodes, progress).T
    arrays = {"hours": hours, "insolation": beam + diffuse, "diffuse": diffuse, "sky": sky, "row_col": nodes}
    if not arguments.points:
        arrays = {name: values.reshape(*shape, *values.shape[1:]) for name, values in arrays.items()}
    return arrays, _notes(land, place.latitude, place.longitude, suns.hours, "terrain" in files)


def _nodes(arguments: SunlightArguments, shape: tuple[int, ...]) -> np.ndarray:
    """Rows and columns, (N, 2)."""
    rows, columns = shape
    if not arguments.points:
        if rows * columns > NODES:
            raise LimitError(
                "points",
                f"are left out, and all {rows:,} x {columns:,} nodes are too many",
                f"at most {NODES:,} here; `umbrage sunstudy` takes a whole land",
            )
        return np.indices((rows, columns), np.int64).reshape(2, -1).T
    nodes = np.array(arguments.points, np.int64)
    if (nodes >= [rows, columns]).any():
        raise InputError("points", "a point lies off the grid", f"rows 0 to {rows - 1}, columns 0 to {columns - 1}")
    return nodes


def _notes(land: Land, latitude: float, longitude: float, hours: float, given: bool) -> tuple[str, ...]:
    rows, columns = land.terrain.elevation.shape
    dx, dy = land.terrain.cell_size
    return (
        f"{'the file' if given else 'the default elevation model'}: {rows} x {columns} nodes, {dx:g} x {dy:g} m apart, "
        f"at latitude {latitude:.4f}, longitude {longitude:.4f}; a plain there has {hours:g} h",
        "cloudless sky, evenly bright, no light from the ground; the sun counts by its centre, refracted",
        "flat Earth, level land beyond the grid; no value under trees, which let nothing through",
        *land.terrain.notes,
    )
