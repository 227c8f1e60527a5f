"""The failure catalogue: every case is whole and can be made, and the cases still hold."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer import failing
from renderer.choices import choices_of
from renderer.core.errors import InputError
from renderer.core.registry import phenomena
from renderer.failing import Verdict, failures, judge
from renderer.session import Session
from renderer.steadying import Plan, places, with_choice

CASES = [(scene, name) for scene in phenomena() for name in failures(scene)]


class Pretended:
    """A session of which only states are real."""

    def state(self, *arguments: Any) -> Any:
        return Session.state(self, *arguments)  # type: ignore[arg-type]

    def validate(self, document: Any) -> Any:
        return Session.validate(self, document)  # type: ignore[arg-type]


@pytest.fixture
def session() -> Any:
    return Pretended()


@pytest.fixture(scope="module")
def real() -> Iterator[Session]:
    with Session() as made:
        yield made


def test_there_is_a_catalogue() -> None:
    assert len(CASES) >= 4


@pytest.mark.parametrize(("scene", "name"), CASES)
def test_a_case_is_whole(session: Any, scene: str, name: str) -> None:
    case = failures(scene)[name]
    assert case.title
    assert case.cause.endswith(".")
    assert (case.symptom == "flicker") == bool(case.sweep)
    assert case.measured[1] <= case.threshold < case.measured[0], "its own figures are of a failure and a survivor"
    plan = Plan(scene, case.preset, case.sweep or "camera", case.slot, (), case.sets, case.width, case.steps).checked()
    both = choices_of(scene, case.slot, f"{case.failing},{case.surviving}")
    states = [with_choice(session, plan, places(session, plan)[-1], choice) for choice in both]
    assert getattr(states[0], case.slot) != getattr(states[1], case.slot)


def pretend(monkeypatch: pytest.MonkeyPatch, failing_error: float) -> list[str]:
    """Pictures that err by so much where the depth map's bias is 0, and by 0.1 elsewhere; the references drawn."""
    drawn: list[str] = []

    def truth(session: Any, state: Any, width: int, height: int, judge: str) -> Any:
        drawn.append(judge)
        return SimpleNamespace(linear=np.ones((height, width, 4)))

    def converged(session: Any, state: Any, width: int, height: int) -> Any:
        return SimpleNamespace(linear=np.full((height, width, 4), 1 + (0.1 if state.shadow.bias else failing_error)))

    monkeypatch.setattr(failing, "truth", truth)
    monkeypatch.setattr(failing, "converged", converged)
    return drawn


def test_a_case_is_judged_against_one_reference(session: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = pretend(monkeypatch, 0.9)
    found = judge(session, "forest", "depth_map_shades_itself")
    assert (found.failing, found.surviving) == (pytest.approx(0.9), pytest.approx(0.1))
    assert found.holds
    assert found.document()["holds"] is True
    assert drawn == ["shadow"]


def test_a_mended_technique_is_told(session: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    pretend(monkeypatch, 0.1)
    found = judge(session, "forest", "depth_map_shades_itself")
    assert not found.holds
    assert not Verdict(replace(found.failure, threshold=0.01), 0.5, 0.2).holds, "nor does one hold that none survives"


def test_an_unknown_case_is_named(session: Any) -> None:
    with pytest.raises(InputError, match="depth_map_scintillates") as refused:
        judge(session, "forest", "sea_monsters")
    assert refused.value.field == "failure"


@pytest.mark.slow
@pytest.mark.timeout(1200)
@pytest.mark.parametrize(("scene", "name"), CASES)
def test_the_failing_one_fails_and_the_other_survives(real: Session, scene: str, name: str) -> None:
    found = judge(real, scene, name)
    assert found.surviving <= found.failure.threshold < found.failing
