"""Each technique alone: the right numbers in the right rows, and a chart of those that were timed."""

from __future__ import annotations

import math
from typing import Any

import pytest

from renderer import alone_study
from renderer.benching import variants
from renderer.comparing import NOISY
from renderer.core.errors import InputError
from renderer.study_plan import Plan

MACHINE = {"renderer": "pretended", "cores": 2}


def measured() -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    wrong = {"fogbow": 0.1, "glory": 0.2, "valley": 0.3}
    errors = [
        {
            "techniques": chosen, "preset": preset, "machine": MACHINE, "relative_rmse": error * factor,
            "relative_rmse_without_noise": error * factor - 0.01, "flip_mean": 0.05, "reference_standard_error": 0.04,
        }
        for preset, error in wrong.items()
        for chosen in variants("clouds")
        for factor in [3 if chosen["phase"] == "rayleigh" else 1]
    ]  # fmt: skip
    times = [
        {"techniques": chosen, "preset": "fogbow", "parameters": {"moves": what},
         "yardsticks": 2.0 if chosen["scattering"] == "single" else 4.0}
        for chosen in variants("clouds") for what in ("sun", "camera")
    ]  # fmt: skip
    return errors, times


def test_each_technique_has_its_own_row() -> None:
    errors, times = measured()
    baked = {"phase.rayleigh": {"bytes": 12.0, "seconds": 0.5}}
    rows = {(row["slot"], row["kind"]): row for row in alone_study.rows_of("clouds", errors, times, baked, 30.0)}
    rayleigh, default = rows["phase", "rayleigh"], rows["phase", "mie"]
    assert (rayleigh["error"], rayleigh["worst"]) == (pytest.approx(0.6), pytest.approx(0.9))
    assert rayleigh["own"] == pytest.approx(0.59)
    assert (rayleigh["bytes"], rayleigh["seconds"]) == (12.0, 0.5)
    assert math.isnan(rayleigh["gained"]), "what no line holds"
    assert (default["error"], default["ms"]) == (pytest.approx(0.2), pytest.approx(120.0))
    assert rows["scattering", "single"]["ms"] == pytest.approx(60.0)
    assert default["default"]
    assert not rayleigh["default"]


def test_tables_and_chart_name_every_technique() -> None:
    errors, times = measured()
    rows = alone_study.rows_of("clouds", errors, times, {}, 30.0)
    text = alone_study.table(rows)
    assert text.count("\n") == len(rows) + 2
    assert "| phase | **mie** | 0.2 | 0.3 |" in text
    by_preset = alone_study.by_preset("clouds", errors)
    assert "| default | 0.1 | 0.2 | 0.3 |" in by_preset
    assert "| phase: rayleigh | 0.3 | 0.6 | 0.9 |" in by_preset
    assert "| reference's standard error | 0.04 | 0.04 | 0.04 |" in by_preset
    labels = [text.get_text() for text in alone_study.chart(rows, "clouds").axes[0].get_legend().get_texts()]
    assert "phase: rayleigh" in labels
    assert len(labels) == len(rows) + 1


def test_a_scene_is_studied_by_the_slots_that_it_has() -> None:
    assert Plan("forest").checked().slots == ("shadow", "light", "geometry")
    assert Plan("clouds").checked().slots == ("geometry",)
    assert list(Plan("clouds").checked().judged) == ["combination"]
    assert len(Plan("forest").checked().judged) == 2
    with pytest.raises(InputError):
        Plan("clouds", slots=("shadow",)).checked()
    assert "clouds" not in NOISY
