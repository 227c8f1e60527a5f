"""The page of orders: which number is which, that charts are made of them, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from renderer import order_study
from server import cli

FOUND = {
    "errors": [
        {"preset": "fur", "order": kind, "wrong": wrong, "relative_rmse": wrong / 2, "worst": 1.0, "milliseconds": 5.0}
        for kind, wrong in (("sxmpvo", 0.0019), ("none", 0.36))
    ],
    "sorting": [{"cells": 144, "relations": 300, "of_pixels": 12, "cycles": 0, "ms": 2.5},
                {"cells": 1200, "relations": 2500, "of_pixels": 90, "cycles": 0, "ms": 20.0}],
    "machine": {"renderer": "none", "cores": 2},
    "size": 192,
}  # fmt: skip


def test_numbers_stand_in_their_columns(tmp_path: Path) -> None:
    text = order_study.write(FOUND, tmp_path)
    assert "| scene | `sxmpvo` | `none` |" in text
    assert "| `fur` | 0.19 (0.00095) | 36.00 (0.18) |" in text
    assert "| 1,200 | 2,500 | 90 | 20.0 |" in text
    assert json.loads((tmp_path / "results.json").read_text()) == FOUND
    assert all((tmp_path / name).stat().st_size > 500 for name in order_study.FILES if name != "table.md")


def test_every_scene_that_stands_alone_is_drawn() -> None:
    names = order_study.presets_of()
    assert {"fur", "plane_fog", "teapot_wicker"} <= set(names)
    assert "fur_growing" not in names


@pytest.mark.parametrize(("words", "field"), [(["--size", "8"], "--size"), (["--presets", "hair"], "--presets")])
def test_what_is_refused(words: list[str], field: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["orders", *words]) != 0
    assert field in capsys.readouterr().err
