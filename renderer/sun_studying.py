"""Sun studies: hours of direct sun and irradiation over a whole land, in blocks of rows that each are a bake.

A block is computed in a worker process, or on whatever machines an executor has, and kept under a key of the land, the
place and the range: a study that was stopped goes on with the blocks that are missing.
"""

from __future__ import annotations

import functools
import hashlib
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.core.baking import bake_key
from renderer.core.cache import Cache
from renderer.core.channel import Progress
from renderer.core.errors import InputError, LimitError, UmbrageError
from renderer.core.params import validate
from renderer.core.registry import phenomenon
from renderer.core.technique import Arrays, Bake
from renderer.core.work import Report, Task, Workers
from renderer.forest.world_scale import CELL
from renderer.sun_study import SunStudy, meta_of
from renderer.world import sun, sun_course, sunlight, sunlight_kernels
from renderer.world.sun_course import Place, SunlightPeriod, course
from renderer.world.sunlight import Light
from renderer.world.sunlit_land import Land, check_receiver, land_of_files, place_of
from renderer.world.terrain import DEFAULT_CENTRE, crop, default_terrain, load_terrain

if TYPE_CHECKING:
    from renderer.session import Session

BLOCK = 1 << 17
"""Nodes of a block: some ten seconds of a year on one core, all that an interruption costs."""

NODES = 1 << 24
"""Most nodes of a land: half an hour of two cores for a year."""

SECONDS_PER_NODE = 50e-6
"""On two cores, for a year: to announce the cost."""


def _kept(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]) -> Arrays:
    """A land is put into the cache by whoever asks for a study of it; nobody else could make it."""
    raise UmbrageError("the land is no longer in the cache: start the study again")


def _keep(land: Land, cache: Cache) -> Bake:
    """Lay the land where workers find it, under a key of its content."""
    arrays = {"ground": land.terrain.elevation, "surface": np.asarray(land.surface, np.float32)}
    digest = hashlib.sha256()
    for array in arrays.values():
        digest.update(repr(array.shape).encode() + np.ascontiguousarray(array).tobytes())
    bake = Bake("land", _kept, {"digest": digest.hexdigest()})
    if bake_key(bake) not in cache:
        cache.put(bake_key(bake), arrays)
    return bake


def bake_block(arguments: dict[str, Any], inputs: dict[str, Arrays], progress: Callable[[float, str], None]) -> Arrays:
    """Light of some rows of a land.

    Args:
        arguments: `period`, as `SunlightPeriod`; `place`, as `Place`; `cell_size`; `rows`, first and one past the last;
            `code`.
        inputs: `land`, with `ground` and `surface`, m above the sea.

    Returns:
        `light` (rows, columns, 4) float32, as `Light.at`.
    """
    progress(0.0, "following the sun")
    period = SunlightPeriod.model_validate(arguments["period"])
    low, high = arguments["place"]["altitudes"]
    place = Place(**{**arguments["place"], "altitudes": (low, high)})
    ground, surface = inputs["land"]["ground"], inputs["land"]["surface"]
    first, last = arguments["rows"]
    dx, dy = arguments["cell_size"]
    light = Light(ground, surface, (dx, dy), course(period, place), place.altitudes, period.receiver)
    nodes = np.stack(np.meshgrid(np.arange(first, last), np.arange(ground.shape[1]), indexing="ij"), axis=-1)
    found = light.at(nodes.reshape(-1, 2), progress)
    return {"light": found.reshape(last - first, ground.shape[1], -1)}


def study(
    workers: Workers, cache: Cache, land: Land, period: Mapping[str, Any], on_progress: Report | None = None
) -> SunStudy:
    """Study a land; blocks.

    Args:
        workers: compute the blocks. cache: keeps them.
        land: what is lit.
        period: a document of `SunlightPeriod`.
        on_progress: told how far the whole is; may raise `Cancelled`.

    Raises:
        InvalidDocument, InputError, LimitError: naming the argument.
        Cancelled: by `on_progress`.
    """
    checked: SunlightPeriod = validate(SunlightPeriod, dict(period))
    rows, columns = land.terrain.elevation.shape
    if rows * columns > NODES:
        raise LimitError("terrain", f"has {rows:,} x {columns:,} nodes", f"at most {NODES:,} in all")
    check_receiver(checked.receiver, land)
    place = place_of(checked, land)
    suns = course(checked, place)  # now, so that a wrong range is refused before anything starts
    bakes = _blocks(checked, place, land, cache)
    parts = _computed(workers, cache, bakes, on_progress)
    whole = np.concatenate([part["light"] for part in parts])
    hours, beam, diffuse, sky = np.moveaxis(whole, -1, 0)
    return SunStudy(
        hours,
        beam + diffuse,
        diffuse,
        sky,
        land.terrain,
        meta_of(checked, place, suns.hours, land.terrain, land.wooded),
    )


@functools.cache
def _code() -> str:
    """Hash of what computes a block: a method that was mended cannot keep what it gave before."""
    digest = hashlib.sha256()
    for module in (sun, sun_course, sunlight, sunlight_kernels):
        digest.update(Path(str(module.__file__)).read_bytes())
    return digest.hexdigest()


def _blocks(period: SunlightPeriod, place: Place, land: Land, cache: Cache) -> list[Bake]:
    rows, columns = land.terrain.elevation.shape
    kept = _keep(land, cache)
    several = max(1, BLOCK // columns)
    where = {
        "latitude": place.latitude,
        "longitude": place.longitude,
        "bearing": place.bearing,
        "altitudes": list(place.altitudes),
    }
    # The place says what these two would.
    document = period.model_dump(mode="json") | {"latitude": None, "longitude": None}
    return [
        Bake(
            f"sun study, rows {first} to {min(first + several, rows) - 1}",
            bake_block,
            {
                "period": document,
                "place": where,
                "cell_size": list(land.terrain.cell_size),
                "rows": [first, min(first + several, rows)],
                "code": _code(),
            },
            (kept,),
            seconds=several * columns * SECONDS_PER_NODE,
        )
        for first in range(0, rows, several)
    ]


def _computed(workers: Workers, cache: Cache, bakes: list[Bake], on_progress: Report | None) -> list[Arrays]:
    """The arrays of all blocks; each is a task of its own, so that an executor may spread them over its machines."""
    shares = [1.0 if bake_key(bake) in cache else 0.0 for bake in bakes]
    had, started = sum(shares) / len(bakes), time.monotonic()
    tasks: list[Task[Arrays]] = []

    def tell(number: int, progress: Progress) -> None:
        shares[number] = max(shares[number], progress.fraction)
        share = sum(shares) / len(bakes)
        spent, done = time.monotonic() - started, share - had
        # At first the announced time is the better guess; then the pace so far.
        left = spent * (1 - share) / done if done > 0.05 else sum(bake.seconds for bake in bakes) * (1 - share)
        if on_progress is not None:
            on_progress(Progress("sun study", share, f"{progress.words}, {bakes[number].name[11:]}", left))

    def listener(number: int) -> Report:
        return lambda progress: tell(number, progress)

    try:
        for number, bake in enumerate(bakes):
            tasks.append(workers.run(bake, cache, listener(number)))
        found = []
        for number, task in enumerate(tasks):
            found.append(task.future.result())
            shares[number] = 1.0
    except BaseException:
        for task in tasks:
            task.cancel()
        raise
    return found


def land_of(session: Session, state: Any, files: Mapping[str, Path]) -> Land:
    """The square that a state draws, with the tops of its stands; without a state, the land of files.

    Raises:
        InputError: the scene has no land.
    """
    if state is None:
        return land_of_files(files)
    bakes = [bake for bake in phenomenon(state.scene).bakes(state) if bake.name == "terrain"]
    if not bakes:
        raise InputError("scene", "has no land that the sun could shine on", "forest")
    baked = session.compute(bakes[0])
    elevation, base = baked["elevation"], np.float32(baked["base"])
    if state.terrain.kind == "built_in":
        whole, centre = default_terrain(), DEFAULT_CENTRE
    else:
        path = session.assets.get(state.terrain.asset.removeprefix("asset:")).path
        whole = load_terrain(path, reading=state.terrain.reading)
        centre = (state.terrain.east, state.terrain.north)
    square = crop(whole, centre, len(elevation) * CELL, CELL)
    if square.latitude is None and state.sun.kind == "moment":
        square = replace(square, latitude=state.sun.latitude, longitude=state.sun.longitude)
    return Land(replace(square, elevation=elevation + base), baked["surface"] + base)
