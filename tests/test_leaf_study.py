"""What coarser levels lose of the leaves, by every way of filtering."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from renderer import leaf_study
from renderer.forest.lobe import FITS
from tests.forest.blocks import blocks


@pytest.fixture(scope="module")
def rows() -> list[dict[str, Any]]:
    return leaf_study.level_errors(blocks(disorder=0.7), lambda share, words: None)


def test_refitting_loses_less_than_averaging_and_flakes_least(rows: list[dict[str, Any]]) -> None:
    assert [row["level"] for row in rows] == [1, 2]
    for row in rows:
        assert row["refitted"] < 0.95 * row["averaged"]
        assert row["sggx"] < 0.7 * row["averaged"]


def test_where_all_leaves_lie_alike_nothing_is_lost_by_a_mean() -> None:
    for row in leaf_study.level_errors(blocks(disorder=0.0), lambda share, words: None):
        assert row["mean normal"] < 0.1


def test_table_and_chart_say_every_level(rows: list[dict[str, Any]], tmp_path: Path) -> None:
    text = leaf_study.table_of(rows, json.loads(FITS.read_text())["species"])
    for row in rows:
        assert f"| {row['level']} | {0.625 * 2 ** row['level']:g} m | {row['blocks']} | {row['averaged']:.3f} |" in text
    assert all(title in text for title in ("Broadleaf", "Spruce", "Birch"))
    leaf_study.chart_of(rows, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"levels.svg", "levels.png"}
