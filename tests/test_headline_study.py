"""The thesis' six scenes beside its own settings: what is drawn, which number is which, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from renderer import headline_study
from renderer.session import Session
from renderer.world.camera import rays
from server import cli


def state(preset: str, setting: str) -> Any:
    return Session.state(None, "shells", preset, headline_study.sets_of(preset, setting))  # type: ignore[arg-type]


def line(preset: str, setting: str, error: float) -> dict[str, Any]:
    return {
        "preset": preset, "setting": setting, "size": 48, "whole": 128, "frames": 3, "relative_rmse": error,
        "pairing": 2 * error, "standard_error": error / 100, "whole_relative_rmse": 3 * error,
        "whole_pairing": 4 * error, "whole_standard_error": error / 200, "camera": 10 * error, "sun": 20 * error,
        "machine": {"renderer": "none", "cores": 2},
    }  # fmt: skip


@pytest.mark.parametrize("preset", headline_study.SAMPLES)
def test_settings_are_states(preset: str) -> None:
    thesis, default = state(preset, "thesis"), state(preset, "default")
    assert thesis.sampling.samples == headline_study.SAMPLES[preset]
    assert {slot for slot, one in thesis.techniques().items() if one != default.techniques()[slot]} == {
        "order", "sampling", "shadow", "filter", "accumulation",
    }  # fmt: skip
    assert thesis.model_copy(update=default.techniques()) == default


def test_the_middle_has_the_same_rays() -> None:
    whole = state("teapot_relief", "default")
    _, wide = rays(whole.camera, 512, 512, (0.5, 0.5))
    _, narrow = rays(headline_study.middle(whole, 48).camera, 48, 48, (0.5, 0.5))
    np.testing.assert_allclose(narrow, wide[232:280, 232:280], atol=1e-9)


def test_numbers_stand_in_their_columns(tmp_path: Path) -> None:
    lines = [line("tube_rocks", "thesis", 0.3), line("tube_rocks", "default", 0.2)]
    text = headline_study.write(lines, tmp_path)
    assert "| `tube_rocks` | 10 | 0.2 | 0.4 | 0.6 | 0.8 | 2 | 4 | 0.3 | 0.6 | 0.9 | 1.2 | 3 | 6 |" in text
    assert "standard error is 0.003 at most" in text
    assert json.loads((tmp_path / "results.json").read_text()) == lines


@pytest.mark.parametrize(
    ("words", "field"),
    [
        (["--size", "8"], "--size"), (["--whole", "8"], "--whole"), (["--frames", "-1"], "--frames"),
        (["--presets", "fur"], "--presets"),
    ],
)
def test_what_is_refused(words: list[str], field: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["headline", *words]) != 0
    assert field in capsys.readouterr().err
