"""The table of shadow kinds from made-up results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from renderer.core.errors import InputError
from renderer.study.kinds import as_csv, chart, rows, table, write

MACHINE = {"renderer": "llvmpipe (test)", "cores": 2, "commit": "abc"}
ERRORS = {"map, 4": (0.3, 0.5), "map, 8": (0.2, 0.4), "march": (0.1, 0.6), "combination: old": (0.05, 0.1)}
YARDSTICKS = {"map, 4": 0.5, "map, 8": 0.6, "march": 0.8, "combination: old": 0.3}


def results(errors: dict[str, tuple[float, float]] = ERRORS) -> list[dict[str, Any]]:
    """Two kinds of shadow, four techniques and what they cost."""
    lines: list[dict[str, Any]] = []
    for column, kind in enumerate(("land", "combined")):
        for label, found in errors.items():
            lines.append(
                {"kind": "shadow_kind", "column": kind, "label": label, "combination": ":" in label,
                 "relative_rmse": found[column], "flip_mean": 0.04, "flicker": 0.015}
            )  # fmt: skip
    for label, cost in YARDSTICKS.items():
        lines.append({"kind": "time", "techniques": {"contender": label}, "frame_ms": 40 * cost, "yardsticks": cost})
        lines.append({"kind": "bytes", "label": label, "held_bytes": 4_200_000, "baked_bytes": 0, "bake_seconds": 1.5})
    lines.append({"kind": "mask", "column": "land", "preset": "view", "covers": 0.25, "shares": {"land": 1.0}})
    return [{**line, "machine": MACHINE} for line in lines]


def test_rows_run_from_the_most_right_and_end_with_combinations() -> None:
    made = rows(results())
    assert [row.label for row in made] == ["map, 8", "map, 4", "march", "combination: old"]
    costs = {"held_bytes": 4_200_000, "baked_bytes": 0, "bake_seconds": 1.5}
    assert made[0].costs == {"frame_ms": 24, "yardsticks": 0.6, **costs}


def test_the_table_has_every_number_and_marks_the_least_error_of_a_kind() -> None:
    heading, _, first, *rest = table(rows(results())).splitlines()
    assert heading.split(" | ")[1:3] == ["land", "combined"]
    assert first == "| map, 8 | 0.2 / 0.04 / 0.015 | **0.4** / 0.04 / 0.015 | 24 | 0.6 | 4.2 | 0 | 1.5 |"
    assert rest[1].startswith("| march | **0.1** / ")
    assert "**" not in rest[2], "a combination answers for more than its shadow"


def test_what_could_not_be_drawn_has_dashes_and_comes_last() -> None:
    lines = [{**line, "relative_rmse": float("nan"), "flicker": float("nan")} if line.get("label") == "map, 8" else line
             for line in results()]  # fmt: skip
    made = rows(lines)
    assert [row.label for row in made] == ["map, 4", "march", "map, 8", "combination: old"]
    assert "| map, 8 | - / 0.04 / - |" in table(made)
    assert as_csv(made).splitlines()[3].startswith('"map, 8",,0.04,,')


def test_the_chart_has_a_panel_a_kind_and_the_front_of_each() -> None:
    axes = chart(rows(results()), "x").axes
    assert [one.get_title() for one in axes[:2]] == ["land", "combined"]
    fronts = [np.array(one.lines[0].get_xydata()) for one in axes[:2]]
    assert fronts[0] == pytest.approx(np.array([[0.3, 0.05]])), "the combination is cheapest and most right"
    alone = chart(rows([line for line in results() if line.get("label") != "combination: old"]), "x").axes
    assert np.array(alone[0].lines[0].get_xydata()) == pytest.approx(np.array([[0.5, 0.3], [0.6, 0.2], [0.8, 0.1]]))
    assert np.array(alone[1].lines[0].get_xydata()) == pytest.approx(np.array([[0.5, 0.5], [0.6, 0.4]]))


def test_files_are_written_and_machines_never_mixed(tmp_path: Path) -> None:
    write(results(), tmp_path, "Made up", "How.")
    text = (tmp_path / "table.md").read_text()
    assert text.startswith("Made up\n\nHow.\n\n| technique |")
    assert "| `view` | land | 25% | **100%** |" in text
    assert {"speed_accuracy.png", "speed_accuracy.svg", "speed_accuracy.csv"} <= {p.name for p in tmp_path.iterdir()}
    with pytest.raises(InputError, match="2 renderers"):
        rows([*results(), {**results()[0], "machine": {"renderer": "a card"}}])
