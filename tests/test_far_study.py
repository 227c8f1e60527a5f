"""Shells from near and from far: what is seen, which number is which, and what is refused."""

from __future__ import annotations

import json
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer import far_study
from renderer.core.errors import InputError
from renderer.core.registry import phenomenon
from renderer.session import Session
from server import cli, cli_far
from server.cli_far import times_of


class Drawing:
    """A session whose pictures are grey: filtered ones too bright by a tenth from four times as far on, and bare ones
    too opaque by a fifth."""

    def __init__(self) -> None:
        self.sizes: list[tuple[int, int]] = []
        self.gl = SimpleNamespace(info=SimpleNamespace(renderer="none"))

    def __enter__(self) -> Drawing:
        return self

    def __exit__(self, *_: object) -> None: ...

    def state(self, scene: str, preset: str, sets: Any) -> Any:
        return Session.state(self, scene, preset, sets)  # type: ignore[arg-type]

    def describe(self, scene: str) -> Any:
        return {"presets": {name: {"group": ""} for name in phenomenon(scene).presets}}

    def draw(self, state: Any, width: int, height: int, samples: int) -> Any:
        self.sizes.append((width, samples))
        far = state.camera.distance > 3.9 * 2.9 and state.filter.kind != "none"
        bare = not state.base.opaque
        linear = np.full((height, width, 4), 2.2 if far else 2.0)
        linear[..., 3] = 0.6 if far and bare else 0.5
        return SimpleNamespace(linear=linear)


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> Drawing:
    def truth(session: Any, state: Any, width: int, height: int, judge: str, tell: Any) -> Any:
        tell(SimpleNamespace(fraction=0.5, words="tracing"))
        linear = np.full((height, width, 4), 2.0)
        linear[..., 3] = 0.5
        return SimpleNamespace(linear=linear, standard_error=0.32)

    monkeypatch.setattr(far_study, "truth", truth)
    return Drawing()


def test_farther_off_the_picture_holds_as_much(session: Drawing) -> None:
    near, far = (far_study.seen(session, "fur", times, {}).camera for times in (1, 8))  # type: ignore[arg-type]
    assert far.distance == pytest.approx(8 * near.distance)
    held = [camera.distance * math.tan(math.radians(camera.field_of_view) / 2) for camera in (near, far)]
    assert held[0] == pytest.approx(held[1])


def test_brightness_is_of_the_lit_picture_and_opacity_of_the_bare_one(session: Drawing) -> None:
    told: list[float] = []
    lines = far_study.measure(session, ["fur"], "none,mipmap", (1, 8), lambda share, words: told.append(share))  # type: ignore[arg-type]
    found = {(line.label, line.times): (line.brightness, line.opacity) for line in lines}
    assert found["none", 8] == pytest.approx((1.0, 1.0))
    assert found["mipmap", 1] == pytest.approx((1.0, 1.0))
    assert found["mipmap", 8] == found[far_study.DEFAULT, 8] == pytest.approx((1.1, 1.2))
    assert told == sorted(told)
    filtered, default, first = {(512, 1), (64, 4)}, {(512, 64), (64, 64)}, {(512, 1), (64, 1)}
    assert set(session.sizes) == filtered | default | first, "fewer pixels have more samples, and the default settles"
    assert lines[0].error == pytest.approx(0.01)
    assert lines[4].pixel == pytest.approx(8 * lines[0].pixel)


def test_the_camera_steps_back_by_a_thousandth(session: Drawing) -> None:
    (plan,) = far_study.sweeps(session, ["fur"], "none,directional:bias=-1")  # type: ignore[arg-type]
    assert plan.sweep == "camera.distance"
    assert plan.stride * 0.01 == pytest.approx(0.001)
    assert plan.width == 32
    assert [choice.label for choice in plan.choices] == ["none", "directional:bias=-1"]


def test_the_command_leaves_table_chart_and_numbers(
    session: Drawing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(cli_far, "Session", lambda: session)
    monkeypatch.setattr(cli_far, "load", lambda: SimpleNamespace(study=tmp_path))
    words = ["far", "--presets", "fur", "--times", "1,4", "--techniques", "none,directional"]
    assert cli.main(words) == 0
    assert "| fur | directional | +0.0, +0.0 | +10.0, +20.0 | 10.0 | 20.0 |" in capsys.readouterr().out
    folder = tmp_path / "shells" / "distance"
    assert {path.name for path in folder.iterdir()} == set(far_study.FILES)
    assert len(json.loads((folder / "results.json").read_text())) == 8
    for more, message in ((["--times", "far"], "no numbers"), (["--times", "0"], "too near"),
                          (["--techniques", "blur"], "no technique"), (["--presets", "wool"], "wool")):
        assert cli.main([*words, *more]) == 2
        assert message in capsys.readouterr().err
    with pytest.raises(InputError, match="too far"):
        times_of("1,100")
