"""Timing of horizons: what it says of a small grid adds up, and its table shows it."""

from __future__ import annotations

from pathlib import Path

from renderer.study.horizon_bench import AZIMUTHS, time_horizons
from server.bench_report import save

MACHINE = {"renderer": "none", "cores": 2, "system": "test", "python": "3", "commit": "0" * 40}


def test_a_small_grid_is_swept_searched_and_compared(tmp_path: Path) -> None:
    told: list[float] = []
    (line,) = time_horizons((128,), lambda share, words: told.append(share))
    assert told == [0]
    assert (line["nodes"], line["cell_size"], line["azimuths"]) == (128, 32.0, AZIMUTHS)
    assert min(line["swept_per_core"], line["swept"], line["searched_per_core"]) > 0
    assert line["median_error"] < 0.01
    assert line["median_error"] < line["p99_error"] < 2
    save(tmp_path, MACHINE, {"horizons": [line]})
    assert "| 128 x 128 |" in (tmp_path / "table.md").read_text()
