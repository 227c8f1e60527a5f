"""One stand from near and from far: windows with the picture's own pixels, and the ratio of two means."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer import distances
from renderer.core.errors import InputError
from renderer.forest.state import ForestState
from renderer.world.camera import Look, Orbit
from server import cli, cli_distance

STATE = ForestState(camera=Orbit(target=(1.0, 2.0, 3.0), distance=7.0, azimuth=20.0, elevation=30.0))


def pixel(state: Any, size: int) -> float:
    """Width of a pixel at the target [m]."""
    return 2 * state.camera.distance * math.tan(math.radians(state.camera.field_of_view) / 2) / size


@pytest.mark.parametrize("distance", distances.DISTANCES)
def test_far_pixels_are_the_pictures_own_and_near_ones_fine(distance: float) -> None:
    seen = distances.window(STATE, distance, 48)
    own = 2 * distance * math.tan(math.radians(20)) / distances.LINES
    assert seen.camera.target == STATE.camera.target
    assert pixel(seen, 48) == pytest.approx(max(own, min(distances.FINE, own * distances.LINES / 48)))
    assert seen.camera.field_of_view <= distances.FIELD_OF_VIEW + 1e-9


def test_only_an_orbit_has_a_stand_to_stay_with() -> None:
    looking = STATE.model_copy(update={"camera": Look(eye=(0.0, 0.0, 0.0), target=(1.0, 0.0, 0.0))})
    with pytest.raises(InputError, match="orbit") as refused:
        distances.window(looking, 10.0, 16)
    assert refused.value.field == "camera.kind"


@pytest.fixture
def pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """A technique that is a tenth too dark from a kilometre on."""

    def truth(session: Any, state: Any, width: int, height: int, judge: str, tell: Any) -> Any:
        tell(SimpleNamespace(fraction=0.5, words="marching"))
        return SimpleNamespace(linear=np.full((height, width, 4), 2.0), standard_error=0.16)

    def converged(session: Any, state: Any, width: int, height: int) -> Any:
        far = state.camera.distance >= 1000
        return SimpleNamespace(linear=np.full((height, width, 4), 1.8 if far else 2.0))

    monkeypatch.setattr(distances, "truth", truth)
    monkeypatch.setattr(distances, "converged", converged)


@pytest.mark.usefixtures("pictures")
def test_the_ratio_of_the_means_is_told_at_every_distance() -> None:
    told: list[float] = []
    lines = distances.measure(None, STATE, (20.0, 2000.0), 16, "matter", lambda share, words: told.append(share))  # type: ignore[arg-type]
    assert [line.ratio for line in lines] == pytest.approx([1.0, 0.9])
    assert [line.relative_rmse for line in lines] == pytest.approx([0.0, 0.1])
    assert lines[0].standard_error == pytest.approx(0.01)
    assert told == sorted(told)
    assert distances.table(lines).count("\n") == 3


def test_what_pops_and_shimmers_is_told_beyond_what_the_truth_does(monkeypatch: pytest.MonkeyPatch) -> None:
    """A truth that brightens by a tenth a step; pictures that follow, but jump after 300 m and shimmer one by one."""
    begin = 300 * 1.01**-2

    def steps(state: Any) -> float:
        return math.log(state.camera.distance / begin) / math.log(1.01)

    def truth(session: Any, state: Any, width: int, height: int, judge: str, tell: Any) -> Any:
        exact = np.full((height, width, 4), 1 + 0.1 * steps(state))
        return SimpleNamespace(linear=exact, once=exact + 0.02 * (round(steps(state)) % 2))

    def converged(session: Any, state: Any, width: int, height: int) -> Any:
        picture = np.full((height, width, 4), 1 + 0.1 * steps(state) + 0.5 * (state.camera.distance > 301))
        picture[::2] += 0.25 * (state.camera.distance > 301)
        return SimpleNamespace(linear=picture, once=np.full((height, width, 4), 1 + 0.5 * (round(steps(state)) % 2)))

    monkeypatch.setattr(distances, "truth", truth)
    monkeypatch.setattr(distances, "converged", converged)
    (found,) = distances.dolly(None, STATE, (300.0,), 16)  # type: ignore[arg-type]
    assert found.pop == pytest.approx(0.625 / 1.2)
    assert found.jump == pytest.approx(math.sqrt((0.5**2 + 0.75**2) / 2) / 1.2)
    assert found.truth == pytest.approx(0.1 / 1.2)
    assert found.floor == pytest.approx(0.02 / 1.2)
    assert found.shimmer == pytest.approx(math.sqrt((0.4**2 + 0.6**2) / 2) / 1.2)
    assert pixel(distances.window(STATE, 2.0, 16, 0.0), 16) == pytest.approx(distances.footprint(2.0)), "its own pixels"
    assert distances.stretches([found]).count("\n") == 2


@pytest.mark.usefixtures("pictures")
def test_the_command_prints_a_table_and_keeps_the_numbers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Opened:
        def __enter__(self) -> Any:
            return self

        def __exit__(self, *_: object) -> None: ...

        def state(self, *_: object) -> ForestState:
            return STATE

    monkeypatch.setattr(cli_distance, "Session", Opened)
    output = tmp_path / "out.json"
    assert cli.main(["distance", "forest", "--distances", "20,2000", "--size", "16", "-o", str(output)]) == 0
    assert "| 2000 |" in capsys.readouterr().out
    kept = json.loads(output.read_text())
    assert [line["ratio"] for line in kept["lines"]] == pytest.approx([1.0, 0.9])
    for words, message in ((["--distances", "near"], "no numbers"), (["--distances", "0"], "no distances"),
                           (["--size", "3"], "8 to 256"), (["--judge", "looks"], "matter")):
        assert cli.main(["distance", "forest", *words]) == 2
        assert message in capsys.readouterr().err
