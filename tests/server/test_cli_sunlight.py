"""The command `sunstudy`: maps into a folder, refusals in words."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from renderer.world.terrain import load_terrain
from server import cli

DAY = ["--start", "2024-06-21", "--end", "2024-06-21", "--minutes", "30"]


@pytest.fixture
def land(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("UMBRAGE_CACHE", str(tmp_path / "cache"))
    path = tmp_path / "land.npz"
    y, x = np.mgrid[:20, :30]
    np.savez(path, elevation=(500 + 80 * np.sin(x / 3) * np.cos(y / 4)).astype(np.float32), cell_size=(25.0, 25.0))
    return path


def test_maps_come_into_a_folder(land: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    place = ["--latitude", "45", "--longitude", "6", "--time-zone", "Europe/Paris"]
    assert cli.main(["sunstudy", "--terrain", str(land), *DAY, *place, "-o", str(out)]) == 0
    told = capsys.readouterr().out
    assert "hours: " in told
    assert "insolation: " in told
    written = {path.name for path in out.iterdir()}
    assert written == {"hours.tif", "hours.png", "insolation.tif", "insolation.png", "sunlight.npz", "sunlight.json"}
    with np.load(out / "sunlight.npz") as arrays:
        assert arrays["hours"].shape == (20, 30)
        assert 0 < arrays["hours"].min() < arrays["hours"].max() <= 15.5
        np.testing.assert_array_equal(load_terrain(out / "hours.tif").elevation, arrays["hours"])
        assert json.loads(str(arrays["meta"]))["arguments"]["time_zone"] == "Europe/Paris"
    assert json.loads((out / "sunlight.json").read_text())["hours"]["unit"] == "h"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--start", "2024-02-30"], "start: is no day of the calendar"),
        (["--start", "2025-06-01", "--latitude", "45", "--longitude", "6"], "end: lies before the first day"),
        (["--latitude", "north"], "latitude"),
        (["--receiver", "moon"], "receiver"),
        ([], "latitude: is not in the land's file"),
    ],
)
def test_a_wrong_argument_is_named(
    land: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], options: list[str], words: str
) -> None:
    assert cli.main(["sunstudy", "--terrain", str(land), *options, "-o", str(tmp_path / "out")]) == cli.REFUSED
    assert words in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_files_that_do_not_fit_are_refused(land: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = ["-o", str(tmp_path / "out")]
    for options, words in (
        (["--terrain", "absent.tif"], "--terrain: there is no file absent.tif"),
        (["--canopy", str(land)], "canopy: stands on no terrain"),
        (["forest", "--terrain", str(land)], "--terrain: is given beside a scene"),
        (["--terrain", str(land), "-o", str(land)], "is no folder"),
    ):
        assert cli.main(["sunstudy", *out, *options]) == cli.REFUSED
        assert words in capsys.readouterr().err
