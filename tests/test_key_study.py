"""The study of key frames on a small tube: halved distances quarter errors, and the page says what was found."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from renderer import key_study
from renderer.core.baking import gather
from renderer.core.cache import Cache
from renderer.core.params import validate
from renderer.core.registry import phenomenon
from renderer.shells.bakes import shell_bake, surface_bake
from renderer.shells.state import ShellsState

LINE = {"surface": "tube", "keys": 8, "texture": 0.0308, "astray": 0.031, "plane": 0.004, "place": 0.008,
        "mebibytes": 1.5, "microseconds": [180.0, 740.0], "picture": 0.09}  # fmt: skip


def test_errors_fall_with_the_square_of_the_distance(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(key_study, "TIMED_S", 1e-6)
    patch = phenomenon("shells").presets[key_study.PRESET].patch
    wanted = {name: patch[name] for name in ("surface", "motion", "course")}
    state = validate(ShellsState, {"scene": "shells", **wanted})
    arrays = dict(gather([surface_bake(state), shell_bake(state)], Cache()))
    coarse, fine = (key_study.errors(state, arrays, count) for count in (16, 64))
    for name in ("texture", "plane"):
        assert 8 < coarse[name] / fine[name] < 32, name
    assert fine["mebibytes"] == pytest.approx(4 * coarse["mebibytes"])
    kept = key_study.sampled(state, 16, "interpolated").course.keys
    assert [key.at for key in kept[:3]] == [0.0, 0.5, 1.0]
    assert kept[1].bend == pytest.approx(7.5)


def test_the_page_has_a_row_a_count_and_a_chart(tmp_path: Path) -> None:
    lines = [{**LINE, "keys": count, "plane": 1 / count**2} for count in (4, 8)]
    found = {"lines": lines, "cells": {"tube": 864}, "machine": {"renderer": "r", "cores": 2}, "size": 64}
    text = key_study.write(found, tmp_path)
    assert "| 8 | 0.0308 | 3.1 | 15.6 | 8 | 9 | 1.5 | 180 | 740 |" in text
    assert {path.name for path in tmp_path.iterdir()} == set(key_study.FILES)
    assert np.frombuffer((tmp_path / "keys.png").read_bytes()[:8], np.uint8)[1:4].tobytes() == b"PNG"
