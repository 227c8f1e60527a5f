"""Terrain files: what is written is read, metres are metres, and what is broken is named."""

from __future__ import annotations

import io
import struct
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from renderer.core.errors import AssetError, InputError, LimitError
from renderer.world.limits import Limits
from renderer.world.terrain import TerrainReading, default_terrain, load_terrain
from renderer.world.terrain_files import save_npz
from tests.world.geotiff import HEIGHTS, tiff


def png(folder: Path, values: np.ndarray) -> Path:
    path = folder / "terrain.png"
    Image.fromarray(values).save(path)
    return path


def npz(folder: Path, **arrays: object) -> Path:
    path = folder / "terrain.npz"
    np.savez(path, **arrays)
    return path


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


def test_an_archive_of_countless_members_is_refused_by_its_directory(tmp_path: Path) -> None:
    """zipfile would hold all of a directory before anyone could count it, here and in 256 MB of them."""
    path = tmp_path / "many.npz"
    with zipfile.ZipFile(path, "w") as archive:
        for number in range(400):
            archive.writestr(f"elevation{number}.npy", b"")
    with pytest.raises(AssetError, match=r"file.*archive directory"):
        load_terrain(path)
    data = npz(tmp_path, elevation=HEIGHTS, cell_size=1.0).read_bytes()
    locator = b"PK\x06\x07" + b"\0" * 16  # a 64-bit directory that could contradict the one that was checked
    path.write_bytes(data[:-22] + locator + data[-22:])
    with pytest.raises(AssetError, match=r"file.*no complete"):
        load_terrain(path)
