from __future__ import annotations

import io
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from server import cli, cli_draw
from server.cli_progress import Bar
from tests.server.fake_session import FakeSession, FakeState, paint


class Opened(FakeSession):
    """The double, as the commands open it."""

    def __init__(self) -> None:
        super().__init__(Path())

    def __enter__(self) -> Opened:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cli_draw, "Session", Opened)


@pytest.mark.usefixtures("fake")
def test_scenes_and_their_parameters_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["scenes"]) == 0
    assert "--preset noon" in capsys.readouterr().out
    assert cli.main(["describe", "fake"]) == 0
    shown = capsys.readouterr().out
    assert "brightness" in shown
    assert "in [0, 1]" in shown
    assert "camera[orbit].azimuth" in shown
    assert cli.main(["describe", "fake", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["name"] == "fake"


@pytest.mark.usefixtures("fake")
@pytest.mark.parametrize("suffix", [".png", ".jpg", ".exr", ".npy"])
def test_a_picture_is_written_in_the_format_of_its_name(tmp_path: Path, suffix: str) -> None:
    output = tmp_path / f"x{suffix}"
    options = ["--set", "quality.kind=draft", "--set", "brightness=0.9", "--size", "20x10", "-o", str(output)]
    assert cli.main(["render", "fake", "--preset", "noon", *options]) == 0
    assert [path.name for path in tmp_path.iterdir()] == [output.name], "no half-written file stays"
    if suffix == ".npy":
        expected = paint(FakeState(brightness=0.9), 20, 10) / np.float32(255)
        assert np.allclose(np.load(output)[..., :3], expected)


@pytest.mark.usefixtures("fake")
def test_a_state_comes_from_a_file(tmp_path: Path) -> None:
    state = tmp_path / "state.json"
    state.write_text(json.dumps({"scene": "fake", "brightness": 0.2, "quality": {"kind": "draft"}}))
    output = tmp_path / "x.npy"
    assert cli.main(["render", "fake", "--state", str(state), "--size", "9x9", "-o", str(output)]) == 0
    assert np.load(output)[-1, 0, 0] == pytest.approx(51 / 255)


@pytest.mark.usefixtures("fake")
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["atlantis"], "scene: there is no such scene (allowed: fake)"),
        (["fake", "--preset", "night"], "preset"),
        (["fake", "--set", "brightness=7"], "brightness"),
        (["fake", "--set", "brightness=NaN"], "brightness"),
        (["fake", "--set", "brightness"], "PATH=VALUE"),
        (["fake", "--set", "walrus=1"], "walrus"),
        (["fake", "--size", "7000x7000"], "4096 px"),
        (["fake", "--size", "0x5"], "--size"),
        (["fake", "--size", "big"], "WxH"),
        (["fake", "--state", "{broken}"], "--state"),
        (["fake", "-o", "x.gif"], ".png"),
        (["fake", "-o", "nowhere/x.png"], "no folder"),
    ],
)
def test_a_wrong_option_is_named_and_nothing_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], options: list[str], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "broken").write_text("{")
    options = ["broken" if option == "{broken}" else option for option in options]
    assert cli.main(["render", "-o", "x.png", *options]) == cli.REFUSED
    told = capsys.readouterr().err
    assert words in told
    assert "Traceback" not in told
    assert [path.name for path in tmp_path.iterdir()] == ["broken"]


@pytest.mark.usefixtures("fake")
def test_a_bake_says_what_it_costs(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["bake", "fake", "--set", "density=5"]) == 0
    assert "about 1 s" in capsys.readouterr().out
    assert cli.main(["bake", "fake", "--set", "density=999"]) == cli.REFUSED
    assert "density: cannot be baked" in capsys.readouterr().err


def test_the_sun_is_measured_without_graphics(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = ["--latitude", "48.85", "--longitude", "2.35", "--date", "2024-06-21", "--time", "12:00:00"]
    assert cli.main(["measure", "sun", *place]) == 0
    shown = json.loads(capsys.readouterr().out)
    # NOAA's solar calculator gives 64.5 degrees for Paris at 12 UT on that day.
    assert np.degrees(shown["elevation_rad"]) == pytest.approx(64.5, abs=0.2)
    assert cli.main(["measure", "sun", *place, "-o", str(tmp_path / "sun.npz")]) == 0
    assert float(np.load(tmp_path / "sun.npz")["elevation_rad"]) == shown["elevation_rad"]


def test_a_horizon_is_measured_from_files(tmp_path: Path) -> None:
    elevation = np.zeros((9, 9))
    elevation[:, 6] = 100.0
    np.savez(tmp_path / "terrain.npz", elevation=elevation, cell_size=np.array([10.0, 10.0]))
    (tmp_path / "points.csv").write_text("row,col\n4,2\n")
    output = tmp_path / "horizon.npz"
    options = ["--terrain", str(tmp_path / "terrain.npz"), "--points", str(tmp_path / "points.csv"), "--azimuths", "4"]
    assert cli.main(["measure", "horizon", *options, "--first", "90", "-o", str(output)]) == 0
    horizon = np.load(output)
    # A wall 100 m high, 40 m to the east.
    assert horizon["elevation_rad"].shape == (1, 4)
    assert horizon["elevation_rad"][0, 0] == pytest.approx(np.arctan2(100, 40))
    assert horizon["distance_m"][0, 0] == pytest.approx(40)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["sun", "--latitude", "95"], "latitude"),
        (["sun", "--time-zone", "Mars/Base"], "time_zone"),
        (["horizon", "--terrain", "nowhere.npz"], "nowhere.npz"),
        (["horizon", "--points", "[[1]]"], "points"),
        (["sun", "-o", "x.txt"], ".json or .npz"),
    ],
)
def test_a_wrong_measurement_is_named(capsys: pytest.CaptureFixture[str], options: list[str], words: str) -> None:
    assert cli.main(["measure", *options]) == cli.REFUSED
    assert words in capsys.readouterr().err


def test_progress_is_a_bar_on_a_terminal_and_lines_in_a_file() -> None:
    progress: Any = SimpleNamespace(name="pattern", fraction=0.5, words="trees", seconds_left=3.0)
    file = io.StringIO()
    bar = Bar(file)
    bar(progress)
    bar(progress)
    bar.close()
    assert file.getvalue() == " 50% pattern: trees, 3 s left\n"
    terminal = io.StringIO()
    terminal.isatty = lambda: True  # type: ignore[method-assign]
    shown = Bar(terminal)
    shown(progress)
    shown.close()
    assert "[############............]  50% pattern" in terminal.getvalue()
