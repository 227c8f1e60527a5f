"""Terrain files: what is written is read, metres are metres, and what is broken is named."""

from __future__ import annotations

import io
import math
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
import tifffile
from PIL import Image

from renderer.core.errors import AssetError, InputError, LimitError
from renderer.world.limits import Limits
from renderer.world.terrain import Terrain, TerrainReading, crop, default_terrain, load_terrain
from renderer.world.terrain_crs import metres_per_degree
from renderer.world.terrain_files import save_npz
from renderer.world.terrain_geotiff import save_geotiff

HEIGHTS = (np.arange(30, dtype=np.float32).reshape(5, 6) * 10).astype(np.float32)
UTM = (1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, 2, 3072, 0, 1, 32633)
DEGREES = (1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326)


def tiff(
    folder: Path,
    values: np.ndarray = HEIGHTS,
    *,
    keys: tuple[int, ...] | None = UTM,
    scale: tuple[float, ...] | None = (20, 25, 0),
    tie: tuple[float, ...] | None = (0, 0, 0, 500_000, 5_000_000, 0),
    more: tuple = (),
    **options,
) -> Path:
    """A GeoTIFF with the tags as given, so that the reader is not judged by our writer."""
    tags = [(34735, "H", len(keys), keys, True)] if keys else []
    tags += [(33550, "d", 3, scale, True)] if scale else []
    tags += [(33922, "d", 6, tie, True)] if tie else []
    path = folder / "terrain.tif"
    tifffile.imwrite(path, values, extratags=[*tags, *more], metadata=None, **options)
    return path


def png(folder: Path, values: np.ndarray) -> Path:
    path = folder / "terrain.png"
    Image.fromarray(values).save(path)
    return path


def npz(folder: Path, **arrays: object) -> Path:
    path = folder / "terrain.npz"
    np.savez(path, **arrays)
    return path


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


def test_a_16_bit_png_needs_its_cells_and_range(tmp_path: Path) -> None:
    path = png(tmp_path, (HEIGHTS * 100).astype(np.uint16))
    with pytest.raises(AssetError, match="cell_size"):
        load_terrain(path)
    with pytest.raises(AssetError, match="elevation_high"):
        load_terrain(path, reading=TerrainReading(cell_size=(5, 5)))
    terrain = load_terrain(path, reading=TerrainReading(cell_size=(5, 6), elevation_low=100, elevation_high=755.35))
    np.testing.assert_allclose(terrain.elevation, 100 + HEIGHTS, atol=1e-3)
    assert terrain.cell_size == (5, 6)
    with pytest.raises(AssetError, match="16-bit"):
        load_terrain(png(tmp_path, HEIGHTS.astype(np.uint8)))


def test_npz_keeps_cells_that_differ_and_the_place(tmp_path: Path) -> None:
    terrain = load_terrain(npz(tmp_path, elevation=HEIGHTS.astype(np.int16), cell_size=(7.5, 9.5)))
    np.testing.assert_array_equal(terrain.elevation, HEIGHTS)
    assert terrain.cell_size == (7.5, 9.5)
    assert load_terrain(npz(tmp_path, elevation=np.asfortranarray(HEIGHTS), cell_size=3.0)).cell_size == (3.0, 3.0)
    np.testing.assert_array_equal(load_terrain(tmp_path / "terrain.npz").elevation, HEIGHTS)
    save_npz(tmp_path / "out.npz", default_terrain())
    again = load_terrain(tmp_path / "out.npz")
    assert (again.cell_size, again.latitude) == (default_terrain().cell_size, default_terrain().latitude)


@pytest.mark.parametrize(
    ("arrays", "field"),
    [
        ({"height": HEIGHTS}, "elevation"),
        ({"elevation": HEIGHTS}, "cell_size"),
        ({"elevation": HEIGHTS, "cell_size": np.nan}, "cell_size"),
        ({"elevation": HEIGHTS, "cell_size": -1.0}, "cell_size"),
        ({"elevation": HEIGHTS, "cell_size": (1.0, 2.0, 3.0)}, "cell_size"),
        ({"elevation": HEIGHTS[:1, :1], "cell_size": 1.0}, "elevation"),
        ({"elevation": HEIGHTS[:1], "cell_size": 1.0}, "elevation"),
        ({"elevation": HEIGHTS.ravel(), "cell_size": 1.0}, "elevation"),
        ({"elevation": np.where(HEIGHTS == 70, np.nan, HEIGHTS), "cell_size": 1.0}, "elevation"),
        ({"elevation": np.where(HEIGHTS == 70, np.inf, HEIGHTS), "cell_size": 1.0}, "elevation"),
        ({"elevation": HEIGHTS > 3, "cell_size": 1.0}, "elevation"),
        ({"elevation": HEIGHTS, "cell_size": 1.0, "latitude": 95.0}, "latitude"),
    ],
)
def test_what_is_no_terrain_is_refused_by_its_field(arrays: dict, field: str, tmp_path: Path) -> None:
    with pytest.raises(AssetError) as refusal:
        load_terrain(npz(tmp_path, **arrays))
    assert refusal.value.field == field


def claiming(folder: Path, shape: tuple[int, ...], payload: bytes = b"") -> Path:
    """An .npz whose `elevation` header claims `shape` float64 values, followed by `payload`."""
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": shape})
    path = folder / "claim.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("elevation.npy", header.getvalue() + payload)
        archive.writestr("cell_size.npy", _npy(np.array(1.0)))
    return path


def _npy(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


def test_a_header_that_claims_2_gb_is_refused_by_its_claim(tmp_path: Path) -> None:
    with pytest.raises(LimitError, match=r"elevation.*2,147,483,648 bytes"):
        load_terrain(claiming(tmp_path, (16384, 16384)))
    with pytest.raises(AssetError, match=r"elevation.*cut short"):
        load_terrain(claiming(tmp_path, (1000, 1000), b"\0" * 100))
    with pytest.raises(LimitError, match="elevation"):
        load_terrain(tiff(tmp_path), Limits(cells=29))
    with pytest.raises(LimitError, match="file"):
        load_terrain(tiff(tmp_path), Limits(file_bytes=100))


def test_a_zip_bomb_is_stopped_at_what_its_header_said(tmp_path: Path) -> None:
    """64 MB of zeros in 64 KB: only the 800 bytes of the claim, and one more, are ever unpacked."""
    with pytest.raises(AssetError, match="elevation"):
        load_terrain(claiming(tmp_path, (10, 10), b"\0" * (64 << 20)))


def test_a_tiff_of_giant_dimensions_is_refused_before_decoding(tmp_path: Path) -> None:
    data = bytearray(tiff(tmp_path).read_bytes())
    for tag in (256, 257, 278):  # width, length and rows per strip, written as one LONG (4) or SHORT (3) each
        at = max(data.find(struct.pack("<HHI", tag, kind, 1)) for kind in (3, 4))
        assert at > 0
        data[at : at + 12] = struct.pack("<HHII", tag, 4, 1, 60_000)
    (tmp_path / "vast.tif").write_bytes(data)
    with pytest.raises(LimitError, match=r"elevation.*60,000 x 60,000"):
        load_terrain(tmp_path / "vast.tif")


def test_a_png_of_giant_dimensions_is_refused_before_decoding(tmp_path: Path) -> None:
    data = bytearray(png(tmp_path, HEIGHTS.astype(np.uint16)).read_bytes())
    data[16:24] = (60_000).to_bytes(4, "big") * 2
    (tmp_path / "vast.png").write_bytes(data)
    with pytest.raises(LimitError, match=r"elevation.*60,000"):
        load_terrain(tmp_path / "vast.png")


def test_truncated_files_are_refused_at_every_tenth(tmp_path: Path) -> None:
    rng = np.random.Generator(np.random.PCG64(1))
    values = rng.integers(0, 65535, (64, 64)).astype(np.uint16)
    reading = TerrainReading(cell_size=(5, 5), elevation_low=0, elevation_high=1000)
    sources = (tiff(tmp_path, values), png(tmp_path, values), npz(tmp_path, elevation=values, cell_size=5.0))
    for source in sources:
        data = source.read_bytes()
        for tenth in range(10):
            cut = tmp_path / "cut"
            cut.write_bytes(data[: len(data) * tenth // 10])
            with pytest.raises(AssetError):
                load_terrain(cut, reading=reading)


def test_200_random_bytes_behind_every_mark_give_words(tmp_path: Path) -> None:
    rng = np.random.Generator(np.random.PCG64(2))
    for mark in (b"", b"II*\0\x08\0\0\0", b"MM\0*", b"II+\0", b"\x89PNG\r\n\x1a\n", b"PK\x03\x04"):
        for _ in range(8):
            path = tmp_path / "noise"
            path.write_bytes(mark + rng.bytes(200))
            with pytest.raises(InputError):
                load_terrain(path)
    with pytest.raises(AssetError, match="file"):
        load_terrain(tmp_path / "missing")
