"""The study of light between ground and clouds: its errors are errors, its failures fail, its files are written."""

from __future__ import annotations

import functools
import json
from pathlib import Path

import numpy as np
import pytest

from renderer import radiosity_charts, radiosity_report, radiosity_ridges, radiosity_study
from renderer.clouds.radiosity.bases import GRID, object_basis
from renderer.core.cache import Cache
from renderer.core.failure import ChartedFailure
from renderer.failing import charted
from renderer.radiosity_failures import CASES
from renderer.radiosity_ridges import Ridge
from renderer.radiosity_study import Case
from server import cli

CHEAP = tuple(case for case in CASES if case.name in ("truncated_disc", "albedo_near_one", "broken_edges"))


def silent(share: float, words: str) -> None:
    """Nobody listens."""


@functools.cache
def scenes(rays: int) -> tuple[Case, ...]:
    return tuple(radiosity_study.cases(rays, Cache(), silent))


def level(name: str) -> Case:
    """A scene of level ground: the generator is left before rays are cast."""
    for case in radiosity_study.cases(64, Cache(), silent):
        if case.scene.name == name:
            return case
    raise AssertionError(name)


@pytest.mark.parametrize("case", CHEAP, ids=lambda case: case.name)
def test_the_failing_one_fails_and_the_surviving_one_survives(case: ChartedFailure) -> None:
    found = charted(case)
    assert found.surviving <= case.threshold < found.failing
    assert found.failing == pytest.approx(case.measured[0], rel=0.05)
    assert found.surviving == pytest.approx(case.measured[1], rel=0.05, abs=1e-3)


def test_an_error_is_relative_to_the_mean_over_what_is_drawn() -> None:
    right = np.ones((128, 128))
    outside = right.copy()
    outside[:20] = 9
    assert radiosity_study.off(outside, right) == 0
    assert radiosity_study.off(1.5 * right, right) == pytest.approx(0.5)
    assert radiosity_study.in_blocks(1.5 * right, right) == pytest.approx(0.5)


def test_level_scenes_meet_the_target() -> None:
    """256 coefficients: 3 % against the truth in the basis' cells, 1.2 floors place by place."""
    for name in ("uniform", "square"):
        case = level(name)
        for kind in ("object", "haar"):
            line, fields = radiosity_study.matrix_line(case, kind, 256)
            for side in ("ground", "cloud"):
                assert line[side]["cells"] <= 0.03
                assert line[side]["ratio"] <= 1.2
        wrong = [field * 1.05 for field in fields]
        assert radiosity_study.in_blocks(wrong[0], case.truth.ground) > 0.03, "five per cent too bright is found"


def test_the_exact_kernel_is_nearest_over_level_ground() -> None:
    case = level("square")
    errors = {
        name: radiosity_study.in_blocks(
            np.kron(radiosity_study.level_planes(case, exchange)[0], np.ones((2, 2))), case.truth.ground
        )
        for name, exchange in radiosity_study.flat_exchanges().items()
    }
    assert errors["fft"] < 0.01
    assert min(error for name, error in errors.items() if name != "fft") > 2 * errors["fft"]


@pytest.mark.slow
def test_scenes_of_relief_meet_the_target() -> None:
    for case in scenes(1024)[2:]:
        line = radiosity_study.matrix_line(case, "haar", 256)[0]
        for side in ("ground", "cloud"):
            assert line[side]["cells"] <= 0.03
            assert line[side]["ratio"] <= 1.2


@pytest.mark.slow
@pytest.mark.parametrize("case", [case for case in CASES if case not in CHEAP], ids=lambda case: case.name)
def test_failures_over_relief(case: ChartedFailure) -> None:
    found = charted(case)
    assert found.surviving <= case.threshold < found.failing


def test_a_sunlit_ridge_is_no_level_ground() -> None:
    """Figure 5.5: a high sun over gentle slopes is harmless, a low one behind a steep ridge is not."""
    harmless, bad = (
        radiosity_ridges.ridge_error(ridge, 16) for ridge in (Ridge(1.0, 5.0, 90.0), Ridge(1.0, 35.0, 15.0))
    )
    assert harmless < 0.02
    assert bad > 0.3
    assert np.isnan(radiosity_ridges.ridge_error(Ridge(4.0, 40.0, 30.0), 16)), "it would pierce the clouds"


def test_solving_takes_the_squares_that_are_asked_for() -> None:
    found = radiosity_study.solving_time(4, 15, 1)
    assert (found["squares"], found["coefficients"]) == (4, 15)
    assert found["solve_ms"] >= 0


def test_the_report_is_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With level scenes alone, one of which stands for the ring."""
    only = level("square")
    monkeypatch.setattr(radiosity_study, "cases", lambda rays, cache, tell: iter([only]))
    monkeypatch.setattr(
        radiosity_ridges, "ridge_lines", lambda rays, tell: [{**vars(Ridge(1.0, 25.0, 30.0)), "error": 0.1}]
    )
    monkeypatch.setattr(radiosity_study, "COUNTS", (15,))
    monkeypatch.setattr(radiosity_charts, "SHOWN", ("fft", "transfer haar 15"))
    solving = radiosity_study.solving_time
    monkeypatch.setattr(radiosity_study, "solving_time", lambda squares, count: solving(2, count, 1))
    monkeypatch.setattr(radiosity_report, "CASES", CHEAP)
    text = radiosity_report.run(tmp_path, 64, silent)
    assert {path.name for path in tmp_path.iterdir()} >= {
        "table.md",
        "results.jsonl",
        "errors.svg",
        "profiles_square.png",
    }
    lines = [json.loads(line) for line in (tmp_path / "results.jsonl").read_text().splitlines()]
    assert {line["part"] for line in lines} == {"scenes", "ridges", "numbers", "failures", "solving"}
    assert "318792" in text
    assert "| NO |" not in text


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (["forest", "--radiosity"], "clouds"),
        (["clouds", "--radiosity", "--rays", "1000"], "power of two"),
        (["clouds", "--radiosity", "--rays", "32"], "power of two"),
    ],
)
def test_what_cannot_be_studied_is_refused(capsys: pytest.CaptureFixture[str], arguments: list[str], word: str) -> None:
    assert cli.main(["study", *arguments]) == 2
    assert word in capsys.readouterr().err


def test_blocks_are_those_of_the_largest_basis() -> None:
    assert object_basis(256).sizes.tolist() == [(GRID // 16) ** 2] * 256
