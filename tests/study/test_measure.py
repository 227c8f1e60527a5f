"""Quantities as the doors ask for them."""

from __future__ import annotations

import io
import json
import zipfile
from pathlib import Path

import numpy as np
import pytest

from renderer.core.errors import AssetError, InputError, InvalidDocument, LimitError
from renderer.study import measure as door


@pytest.fixture
def valley(tmp_path: Path) -> Path:
    path = tmp_path / "valley.npz"
    elevation = np.zeros((11, 11), np.float32)
    elevation[:, 8] = 6.0
    np.savez(path, elevation=elevation, cell_size=np.array([2.0, 5.0]))
    return path


def test_horizon_of_a_users_terrain(valley: Path, tmp_path: Path) -> None:
    points = tmp_path / "points.csv"
    points.write_text("row,col\n5,5\n5,2\n")
    found = door.measure("horizon", {"azimuths": 4}, {"terrain": valley, "points": points})
    assert found.arrays["elevation_rad"].shape == (2, 4)
    assert found.arrays["elevation_rad"][:, 1] == pytest.approx([np.arctan(6 / 6), np.arctan(6 / 12)]), "east"
    assert found.arrays["distance_m"][:, 1] == pytest.approx([6, 12])
    assert found.arrays["elevation_rad"][:, 3] == pytest.approx(0), "west, where nothing stands"
    assert found.meta["units"]["distance_m"].startswith("m")
    assert {"technique", "estimated_error", "source"} <= set(found.meta)


def test_first_azimuth_turns_the_set(valley: Path) -> None:
    found = door.measure("horizon", {"points": [[5, 5]], "azimuths": 2, "first": 90}, {"terrain": valley})
    assert found.arrays["elevation_rad"][0] == pytest.approx([np.arctan(1), 0])
    assert found.arrays["azimuth_rad"] == pytest.approx(np.radians([90, 270]))


def test_the_default_terrain_needs_no_file() -> None:
    found = door.measure("horizon", {"points": [[163, 109]], "azimuths": 16})
    assert found.arrays["elevation_rad"][0, 4] == pytest.approx(0.0480526, abs=1e-6)


def test_points_as_npz_both_ways(valley: Path, tmp_path: Path) -> None:
    one, two = tmp_path / "one.npz", tmp_path / "two.npz"
    np.savez(one, row_col=np.array([[5, 5]]))
    np.savez(two, row=np.array([5]), col=np.array([5]))
    values = [door.measure("horizon", {}, {"terrain": valley, "points": p}).arrays["elevation_rad"] for p in (one, two)]
    assert (values[0] == values[1]).all()


def test_sun_matches_a_published_position() -> None:
    # Reda and Andreas 2004, table A5.1: 2003-10-17 12:30:30, UTC-7, 39.742476 N, 105.1786 W, 1830.14 m
    found = door.measure(
        "sun",
        {
            "date": "2003-10-17",
            "time": "12:30:30",
            "time_zone": "Etc/GMT+7",
            "latitude": 39.742476,
            "longitude": -105.1786,
            "altitude": 1830.14,
        },
    )
    assert np.degrees(found.arrays["azimuth_rad"]) == pytest.approx(194.34024, abs=1e-2)
    assert 90 - np.degrees(found.arrays["elevation_rad"]) == pytest.approx(50.11162, abs=1e-2)
    assert any(note.startswith("sunrise 2003-10-17T0") for note in found.meta["notes"])


def test_json_and_npz_hold_the_same(valley: Path, tmp_path: Path) -> None:
    found = door.measure("horizon", {"points": [[5, 5]]}, {"terrain": valley})
    found.save(tmp_path / "x.json")
    found.save(tmp_path / "x.npz")
    text = json.loads((tmp_path / "x.json").read_text())
    with np.load(tmp_path / "x.npz", allow_pickle=False) as data:
        assert np.array_equal(data["elevation_rad"], np.array(text["elevation_rad"]))
        assert json.loads(str(data["meta"])) == text["meta"]
    with pytest.raises(InputError, match="npz"):
        found.save(tmp_path / "x.csv")


def test_schema_carries_units_and_ranges() -> None:
    described = door.describe("horizon")
    azimuths = described["schema"]["properties"]["azimuths"]
    assert azimuths["minimum"] == 1
    assert described["schema"]["properties"]["first"]["umbrage"]["unit"] == "deg"
    assert [f["name"] for f in described["files"]] == ["terrain", "points"]
    assert {"horizon", "sun", "sunlight", "radiosity"} <= set(door.names())


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"azimuths": 0, "points": [[1, 1]]}, "azimuths"),
        ({"first": float("nan"), "points": [[1, 1]]}, "first"),
        ({"points": [[1]]}, "points.0"),
        ({"wrong": 1}, "wrong"),
    ],
)
def test_wrong_arguments_are_named(arguments: dict[str, object], field: str) -> None:
    with pytest.raises(InvalidDocument) as failure:
        door.measure("horizon", arguments)
    assert any(error.field.startswith(field) for error in failure.value.errors)


def test_other_refusals(valley: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such quantity"):
        door.measure("weight", {})
    with pytest.raises(InputError, match="no point"):
        door.measure("horizon", {})
    with pytest.raises(InputError, match="off the grid"):
        door.measure("horizon", {"points": [[5, 11]]}, {"terrain": valley})
    with pytest.raises(InputError, match="no such file"):
        door.measure("horizon", {"points": [[5, 5]]}, {"mesh": valley})
    with pytest.raises(LimitError):
        door.measure("horizon", {"points": [[5, 5]] * 2000, "azimuths": 3600}, {"terrain": valley})
    bad = tmp_path / "bad.csv"
    for content in (b"1,2\nthree,4\n", b"1;2\n", b"\xff\xfe\x00", b"PK\x03\x04rubbish", b"1,nan\n"):
        bad.write_bytes(content)
        with pytest.raises(AssetError, match="points"):
            door.measure("horizon", {}, {"terrain": valley, "points": bad})
    with pytest.raises(AssetError, match="points"):
        door.measure("horizon", {}, {"points": tmp_path / "absent.npz"})


def test_points_that_unpack_to_gigabytes_are_refused_unread(valley: Path, tmp_path: Path) -> None:
    header, bomb = io.BytesIO(), tmp_path / "bomb.npz"
    claim = {"descr": "<f8", "fortran_order": False, "shape": (100_000_000, 2)}
    np.lib.format.write_array_header_1_0(header, claim)
    with zipfile.ZipFile(bomb, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("row_col.npy", header.getvalue() + bytes(1000))
    with pytest.raises(LimitError, match=r"points: row_col claims 1,600,000,000 bytes"):
        door.measure("horizon", {}, {"terrain": valley, "points": bomb})
