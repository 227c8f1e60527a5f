"""GeoTIFF: metres are metres, north is up, holes are holes, and what is written is read."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from renderer.core.errors import AssetError
from renderer.world.terrain import Terrain, TerrainReading, crop, default_terrain, load_terrain
from renderer.world.terrain_crs import metres_per_degree
from renderer.world.terrain_geotiff import save_geotiff
from tests.world.geotiff import DEGREES, HEIGHTS, UTM, tiff


def test_a_projected_geotiff_keeps_metres_and_place(tmp_path: Path) -> None:
    terrain = load_terrain(tiff(tmp_path))
    np.testing.assert_array_equal(terrain.elevation, HEIGHTS)
    assert terrain.cell_size == (20, 25)
    assert terrain.origin == (500_000, 5_000_000)
    assert terrain.crs.epsg == 32633
    east = 50 / 0.9996 / metres_per_degree(terrain.latitude)[0]  # the centre lies 50 m east of the zone's meridian
    assert terrain.longitude == pytest.approx(15 + east, abs=1e-8)
    assert terrain.latitude == pytest.approx(45.15, abs=0.01)


def test_pixels_that_are_areas_have_their_samples_half_a_cell_in(tmp_path: Path) -> None:
    area = (*UTM[:11], 1, *UTM[12:])
    assert load_terrain(tiff(tmp_path, keys=area)).origin == (500_010, 5_000_000 - 12.5)
    assert load_terrain(tiff(tmp_path, tie=(2, 1, 0, 500_000, 5_000_000, 0))).origin == (500_000 - 40, 5_000_000 + 25)


def test_degrees_become_metres_by_latitude(tmp_path: Path) -> None:
    """At 60 degrees a degree of longitude is 55,800 m and one of latitude 111,412 m."""
    terrain = load_terrain(tiff(tmp_path, keys=DEGREES, scale=(0.001, 0.001, 0), tie=(0, 0, 0, 10, 60.0025, 0)))
    assert terrain.cell_size == pytest.approx((55.800, 111.412), abs=1e-3)
    assert (terrain.latitude, terrain.longitude) == pytest.approx((60, 10.003))


def test_feet_and_web_mercator_become_metres(tmp_path: Path) -> None:
    feet = (1, 1, 0, 4, 1024, 0, 1, 1, 3072, 0, 1, 2227, 3076, 0, 1, 9003, 4099, 0, 1, 9002)
    terrain = load_terrain(tiff(tmp_path, keys=feet))
    assert terrain.cell_size == pytest.approx((20 * 1200 / 3937, 25 * 1200 / 3937))
    np.testing.assert_allclose(terrain.elevation, HEIGHTS * 0.3048, rtol=1e-6)
    mercator = (1, 1, 0, 2, 1024, 0, 1, 1, 3072, 0, 1, 3857)
    y = 6_378_137 * math.asinh(math.tan(math.radians(60)))
    stretched = load_terrain(tiff(tmp_path, keys=mercator, tie=(2.5, 2, 0, 0, y, 0)))
    assert stretched.cell_size == pytest.approx((10, 12.5), rel=1e-4)


def test_rows_that_run_north_are_turned_over_and_rotation_is_refused(tmp_path: Path) -> None:
    matrix = np.array([[20, 0, 0, 500_000], [0, 25, 0, 4_999_900], [0, 0, 0, 0], [0, 0, 0, 1]], dtype=float)

    def with_matrix(values: np.ndarray) -> Path:
        return tiff(tmp_path, scale=None, tie=None, more=((34264, "d", 16, tuple(values.ravel()), True),))

    terrain = load_terrain(with_matrix(matrix))
    np.testing.assert_array_equal(terrain.elevation, HEIGHTS[::-1])
    assert terrain.origin == (500_000, 5_000_000)
    matrix[0, 1] = matrix[1, 0] = 3
    with pytest.raises(AssetError, match=r"cell_size.*rotated"):
        load_terrain(with_matrix(matrix))


@pytest.mark.parametrize(
    ("values", "nodata"),
    [
        (np.where(HEIGHTS == 70, -9999, HEIGHTS).astype(np.int16), "-9999"),
        (np.where(HEIGHTS == 70, np.finfo(np.float32).min, HEIGHTS).astype(np.float32), "-3.4028234663852886e+38"),
        (np.where(HEIGHTS == 70, np.nan, HEIGHTS).astype(np.float64), "nan"),
        (np.where(HEIGHTS == 70, 65535, HEIGHTS).astype(np.uint16), "65535"),
    ],
)
def test_holes_of_every_kind_are_named_and_filled_on_request(values: np.ndarray, nodata: str, tmp_path: Path) -> None:
    path = tiff(tmp_path, values, more=((42113, "s", 0, nodata, True),))
    with pytest.raises(AssetError, match=r"elevation.*1 holes.*row 1, column 1"):
        load_terrain(path)
    # A plane has the value 70 there; the four neighbours are its mean.
    np.testing.assert_allclose(load_terrain(path, reading=TerrainReading(holes="fill")).elevation[1, 1], 70, atol=0.01)


def test_a_no_data_value_that_cannot_occur_is_no_hole(tmp_path: Path) -> None:
    path = tiff(tmp_path, HEIGHTS.astype(np.uint16), more=((42113, "s", 0, "-9999", True),))
    np.testing.assert_array_equal(load_terrain(path).elevation, HEIGHTS)


def test_the_files_own_scale_is_applied(tmp_path: Path) -> None:
    items = '<Item name="SCALE" sample="0" role="scale">0.1</Item><Item name="OFFSET" role="offset">-100</Item>'
    text = f"<GDALMetadata>{items}</GDALMetadata>"
    terrain = load_terrain(tiff(tmp_path, HEIGHTS.astype(np.uint16), more=((42112, "s", 0, text, True),)))
    np.testing.assert_allclose(terrain.elevation, HEIGHTS * 0.1 - 100, rtol=1e-5)


@pytest.mark.parametrize(
    "options",
    [
        {"compression": "deflate", "predictor": True},
        {"compression": "lzw"},
        {"tile": (16, 16)},
        {"bigtiff": True},
        {"byteorder": ">"},
        {"compression": "zstd"},
    ],
)
def test_every_common_layout_is_read(options: dict, tmp_path: Path) -> None:
    np.testing.assert_array_equal(load_terrain(tiff(tmp_path, **options)).elevation, HEIGHTS)


def test_a_written_geotiff_is_read_with_its_coordinate_system(tmp_path: Path) -> None:
    path = tmp_path / "out.tif"
    for source in (tiff(tmp_path), tiff(tmp_path, keys=(*UTM[:11], 1, *UTM[12:]))):
        terrain = load_terrain(source)
        save_geotiff(path, terrain.elevation, terrain)
        again = load_terrain(path)
        np.testing.assert_array_equal(again.elevation, terrain.elevation)
        assert (again.cell_size, again.origin, again.crs) == (terrain.cell_size, terrain.origin, terrain.crs)
    square = crop(default_terrain(), (1000, -2000), 800, 8)
    save_geotiff(path, square.elevation, square)
    again = load_terrain(path)
    assert again.crs.epsg == 4326
    assert again.origin == pytest.approx(square.origin, abs=1e-9)
    assert (again.latitude, again.longitude) == pytest.approx((square.latitude, square.longitude), abs=1e-9)
    assert again.cell_size == pytest.approx(square.cell_size, rel=0.006)  # 111,200 m a degree against the ellipsoid
    with pytest.raises(AssetError, match="elevation"):
        save_geotiff(path, HEIGHTS, square)
    plain = Terrain(HEIGHTS, (3.0, 4.0))
    save_geotiff(path, HEIGHTS, plain)
    assert load_terrain(path).cell_size == (3.0, 4.0)


def test_a_tiff_without_a_place_needs_a_cell_size(tmp_path: Path) -> None:
    path = tiff(tmp_path, keys=None, scale=None, tie=None)
    with pytest.raises(AssetError, match="cell_size"):
        load_terrain(path)
    assert load_terrain(path, reading=TerrainReading(cell_size=(5, 6))).cell_size == (5, 6)
    with pytest.raises(AssetError, match=r"cell_size.*unit"):
        load_terrain(tiff(tmp_path, keys=None, scale=(0.001, 0.001, 0)))
    assert load_terrain(tiff(tmp_path, keys=None)).cell_size == (20, 25)


def test_several_bands_and_other_types_are_refused(tmp_path: Path) -> None:
    bands = {"photometric": "rgb"}
    for values, options in ((np.zeros((5, 6, 3), dtype=np.uint8), bands), (np.zeros((5, 6), dtype=np.complex64), {})):
        with pytest.raises(AssetError) as refusal:
            load_terrain(tiff(tmp_path, values, **options))
        assert refusal.value.field == "elevation"
