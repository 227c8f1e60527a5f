"""Sun studies: blocks that make a whole, go on where they were stopped, and leave with their place on Earth."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from renderer import sun_studying
from renderer.core.baking import bake_key
from renderer.core.cache import Cache
from renderer.core.channel import Progress
from renderer.core.errors import Cancelled, InputError, InvalidDocument, LimitError
from renderer.core.technique import Arrays
from renderer.core.work import Workers
from renderer.sun_studying import study
from renderer.world.sun_course import SunlightPeriod, course
from renderer.world.sunlight import Light
from renderer.world.sunlit_land import Land, land_of, place_of
from renderer.world.terrain import Terrain, load_terrain
from renderer.world.terrain_crs import Crs
from renderer.world.terrain_grid import placed

DAY = {"start": "2024-03-20", "end": "2024-03-20"}


def hills(rows: int = 40, columns: int = 30) -> Terrain:
    """Hills near Grenoble, in UTM zone 31."""
    y, x = np.mgrid[:rows, :columns]
    elevation = (400 + 60 * np.sin(x / 4.0) * np.cos(y / 5.0)).astype(np.float32)
    return placed(Terrain(elevation, (25.0, 25.0), (711_000.0, 5_010_000.0), Crs(32631, False)))


@pytest.fixture
def workers() -> Iterator[Workers]:
    with ThreadPoolExecutor(1) as pool:
        found = Workers(pool)
        yield found
        found.close()


@pytest.fixture
def cache(tmp_path: Path) -> Cache:
    return Cache(tmp_path / "cache")


def test_blocks_make_the_whole(workers: Workers, cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sun_studying, "BLOCK", 30 * 13)
    land = land_of(hills())
    found = study(workers, cache, land, DAY)
    period = SunlightPeriod(**DAY)
    place = place_of(period, land)
    ground = land.terrain.elevation
    light = Light(ground, ground, (25.0, 25.0), course(period, place), place.altitudes, "ground")
    whole = light.at(np.stack(np.indices(ground.shape).reshape(2, -1), axis=1)).reshape(40, 30, 4)
    np.testing.assert_array_equal(found.hours, whole[..., 0])
    np.testing.assert_array_equal(found.insolation, whole[..., 1] + whole[..., 2])
    assert found.meta["hours_on_a_plain"] == pytest.approx(12.25, abs=0.25)
    assert 0 < found.hours.min() < found.hours.max() <= found.meta["hours_on_a_plain"]


def test_a_stopped_study_goes_on_where_it_was(workers: Workers, cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sun_studying, "BLOCK", 30 * 10)
    land, period = land_of(hills()), SunlightPeriod(**DAY)
    keys = [bake_key(block) for block in sun_studying._blocks(period, place_of(period, land), land, cache)]
    real = sun_studying.bake_block

    def stopped(arguments: Any, inputs: Any, progress: Any) -> Arrays:
        if arguments["rows"][0] >= 20:
            raise Cancelled("as a worker does whose owner left")
        return real(arguments, inputs, progress)

    stopped.__module__, stopped.__qualname__ = real.__module__, real.__qualname__
    monkeypatch.setattr(sun_studying, "bake_block", stopped)
    with pytest.raises(Cancelled):
        study(workers, cache, land, DAY)
    monkeypatch.setattr(sun_studying, "bake_block", real)
    assert [key in cache for key in keys] == [True, True, False, False]
    assert not list(cache.folder.rglob(".writing*"))
    for key in keys[:2]:  # what is there is not made again: a mark put in its place comes back
        cache.put(key, {"light": np.full((10, 30, 4), 7.0, np.float32)})
    found = study(workers, cache, land, DAY)
    assert np.all(found.hours[:20] == 7.0)
    assert np.all((found.hours[20:] != 7.0) & (found.hours[20:] > 0))


def test_progress_is_told_and_may_stop_it(workers: Workers, cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sun_studying, "BLOCK", 30 * 10)
    told: list[Progress] = []
    study(workers, cache, land_of(hills()), DAY, told.append)
    shares = [progress.fraction for progress in told]
    assert shares
    assert shares == sorted(shares)
    assert 0 <= shares[0] <= shares[-1] <= 1

    def enough(progress: Progress) -> None:
        raise Cancelled("enough")

    with pytest.raises(Cancelled):
        study(workers, cache, land_of(hills()), {**DAY, "minutes": 7}, enough)


def test_the_geotiff_keeps_place_and_coordinate_system(workers: Workers, cache: Cache, tmp_path: Path) -> None:
    terrain = hills()
    found = study(workers, cache, land_of(terrain), DAY)
    path = tmp_path / "hours.tif"
    path.write_bytes(found.geotiff("hours"))
    read = load_terrain(path)
    np.testing.assert_array_equal(read.elevation, found.hours)
    assert read.crs is not None
    assert (read.crs.epsg, read.origin, read.cell_size) == (32631, terrain.origin, terrain.cell_size)


def test_maps_and_numbers(workers: Workers, cache: Cache) -> None:
    terrain = hills()
    canopy = np.zeros(terrain.elevation.shape, np.float32)
    canopy[10:20, 5:15] = 18.0
    found = study(workers, cache, land_of(terrain, canopy), DAY)
    picture = np.asarray(Image.open(io.BytesIO(found.picture("insolation"))))
    assert picture.shape == (40, 30, 4)
    np.testing.assert_array_equal(picture[..., 3] == 0, canopy > 0)
    np.testing.assert_array_equal(np.isnan(found.hours), canopy > 0)
    numbers = json.loads(json.dumps(found.numbers, allow_nan=False))
    assert numbers["hours"]["lowest"] < numbers["hours"]["mean"] < numbers["hours"]["highest"]
    assert numbers["insolation"]["unit"] == "kWh m-2"
    assert picture[..., :3][found.insolation == np.nanmax(found.insolation)][0].tolist() == list(
        bytes.fromhex(numbers["insolation"]["colours"][-1][1:])
    )
    tops = study(workers, cache, land_of(terrain, canopy), {**DAY, "receiver": "canopy"})
    assert not np.isnan(tops.hours).any()


NOWHERE = Terrain(np.array([[1.0, 2.0], [3.0, 5.0]], np.float32), (10.0, 10.0))


@pytest.mark.parametrize(
    ("land", "period", "field"),
    [
        (land_of(NOWHERE), {}, "latitude"),
        (land_of(NOWHERE), {"latitude": 3.0}, "longitude"),
        (land_of(hills()), {"receiver": "canopy"}, "receiver"),
        (land_of(hills(), np.full((40, 30), 9.0)), {"receiver": "ground"}, "receiver"),
        (land_of(hills()), {"start": "2025-01-01"}, "end"),
    ],
)
def test_what_cannot_be_studied_is_said(
    workers: Workers, cache: Cache, land: Land, period: dict[str, object], field: str
) -> None:
    with pytest.raises(InputError) as refused:
        study(workers, cache, land, period)
    assert refused.value.field == field
    assert not cache.folder.exists(), "nothing was begun"


def test_wrong_arguments_and_too_much_land(workers: Workers, cache: Cache, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InvalidDocument, match="no day of the calendar"):
        study(workers, cache, land_of(hills()), {"start": "2024-13-01"})
    monkeypatch.setattr(sun_studying, "NODES", 1000)
    with pytest.raises(LimitError, match="40 x 30 nodes"):
        study(workers, cache, land_of(hills()), DAY)
