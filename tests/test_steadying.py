"""Sweeps: where they go, how techniques are named, and a whole measurement over made-up pictures."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer import steadying
from renderer.choices import Choice, choices_of, plain
from renderer.core.errors import InputError
from renderer.session import Session
from renderer.steadying import Plan, places
from renderer.study.sweep import read
from renderer.world.camera import pose
from renderer.world.sun import angles


class Pretended:
    """A session of which only states are real."""

    def __init__(self) -> None:
        self.gl = SimpleNamespace(info=SimpleNamespace(renderer="pretended"))

    def state(self, *arguments: Any) -> Any:
        return Session.state(self, *arguments)  # type: ignore[arg-type]

    def validate(self, document: Any) -> Any:
        return Session.validate(self, document)  # type: ignore[arg-type]

    def exposure_ev(self, state: Any) -> float:
        return 0.0


@pytest.fixture
def session() -> Any:
    return Pretended()


def plan(sweep: str, **changes: Any) -> Plan:
    return Plan("forest", "low_sun", sweep, **changes).checked()


def test_the_sun_goes_round_and_up_by_quarters_of_a_degree(session: Any) -> None:
    round_, up = (
        np.degrees([angles(state.sun) for state in places(session, plan(sweep))])
        for sweep in ("sun_azimuth", "sun_elevation")
    )
    assert len(round_) == 17
    np.testing.assert_allclose(np.diff(round_, axis=0), np.tile([0.25, 0], (16, 1)), atol=1e-9)
    np.testing.assert_allclose(np.diff(up, axis=0), np.tile([0, 0.25], (16, 1)), atol=1e-9)
    assert up[0, 1] < 0 < up[-1, 1], "through the horizon"


@pytest.mark.parametrize("sets", [
    {}, {"camera": {"kind": "look", "eye": [0, 0, 90], "target": [300, 400, 90]}},
    {"camera": {"kind": "orthographic", "width": 500}},
])  # fmt: skip
def test_the_camera_goes_aside_by_a_thousandth_of_its_distance(session: Any, sets: dict[str, Any]) -> None:
    states = places(session, plan("camera", sets=sets, steps=2))
    first, last = pose(states[0].camera), pose(states[2].camera)
    distance = 650.0 if not sets else 500.0
    assert math.dist(first.eye, last.eye) == pytest.approx(0.002 * distance)
    np.testing.assert_allclose(first.forward, last.forward, atol=1e-9)


def test_several_steps_may_be_taken_at_once(session: Any) -> None:
    coarse = [angles(state.sun)[0] for state in places(session, plan("sun_azimuth", steps=2, stride=45.0))]
    np.testing.assert_allclose(np.degrees(np.diff(coarse)), 11.25)


def test_a_parameter_grows_by_hundredths(session: Any) -> None:
    values = [state.ground.tint_strength for state in places(session, plan("ground.tint_strength", steps=2))]
    assert values == pytest.approx([0.35, 0.3535, 0.357])


@pytest.mark.parametrize(("sweep", "words"), [
    ("moon", "nothing to sweep"), ("shadow.kind", "no number"), ("camera.target", "no number"),
    ("shadow.nothing", "nothing to sweep"),
])  # fmt: skip
def test_what_cannot_be_swept_is_refused(session: Any, sweep: str, words: str) -> None:
    with pytest.raises(InputError, match=words) as refused:
        places(session, plan(sweep))
    assert refused.value.field == "sweep"


@pytest.mark.parametrize(("changes", "field"), [
    ({"slot": "hat"}, "slot"), ({"width": 1000}, "width"), ({"steps": 0}, "steps"),
])  # fmt: skip
def test_a_wrong_plan_names_its_option(changes: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as refused:
        plan("camera", **changes)
    assert refused.value.field == field


def test_techniques_are_named_with_their_parameters() -> None:
    found = choices_of("forest", "shadow", "none,depth_shadow_map:resolution=2048:snapping=true:bias=0.5")
    assert [choice.kind for choice in found] == ["none", "depth_shadow_map"]
    assert found[1].parameters == {"resolution": 2048, "snapping": True, "bias": 0.5}
    assert {choice.kind for choice in choices_of("forest", "light", "")} >= {"lambert", "gouraud"}
    assert plain("noon") == "noon"
    for text in ("hat", "none:strength"):
        with pytest.raises(InputError) as refused:
            choices_of("forest", "shadow", text)
        assert refused.value.field == "techniques"


def pretend(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Pictures in which a shadow map of 512 texels flickers by a tenth and everything else stands still."""
    drawn: list[str] = []

    def converged(session: Any, state: Any, width: int, height: int) -> Any:
        drawn.append(state.shadow.kind)
        restless = state.shadow.kind == "depth_shadow_map" and state.shadow.resolution == 512
        value = 1 + 0.1 * restless * (len(drawn) % 2)
        once = np.full((height, width, 4), 1 + 0.3 * (len(drawn) % 2))
        return SimpleNamespace(linear=np.full((height, width, 4), value), once=once)

    def truth(session: Any, state: Any, width: int, height: int, judge: str) -> Any:
        assert judge == "shadow"
        return SimpleNamespace(linear=np.full((height, width, 4), 1.0), standard_error=0.01)

    monkeypatch.setattr(steadying, "converged", converged)
    monkeypatch.setattr(steadying, "truth", truth)
    return drawn


def test_a_sweep_is_measured_once(session: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = pretend(monkeypatch)
    choices = choices_of("forest", "shadow", "none,depth_shadow_map:resolution=512,depth_shadow_map:resolution=1024")
    made = plan("sun_azimuth", choices=choices, width=16, steps=3)
    told: list[float] = []
    lines = steadying.run(session, [made], tmp_path, lambda share, words: told.append(share))
    assert [one["flicker"] for one in lines] == pytest.approx([0, 0.1, 0])
    assert [one["once"]["flicker"] for one in lines] == pytest.approx([0.3] * 3)
    assert lines[1]["size"] == [16, 9]
    assert lines[1]["reference_standard_error"] == 0.01
    assert told == sorted(told)
    assert len(drawn) == 12
    assert len(list((tmp_path / "worst").iterdir())) == 3
    steadying.run(session, [made], tmp_path)
    assert len(drawn) == 12, "what is known is not drawn again"
    assert len(read(tmp_path / "results.jsonl")) == 3


def test_a_parameter_that_there_is_not_is_named(session: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pretend(monkeypatch)
    made = plan("camera", choices=(Choice("none:hat=1", "none", {"hat": 1}),), steps=1, width=16)
    with pytest.raises(InputError, match="hat"):
        steadying.run(session, [made], tmp_path)
