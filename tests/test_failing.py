"""The failure catalogue: every case is whole and can be made, and the cases still hold."""

from __future__ import annotations

import io
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from renderer import failing
from renderer.choices import choices_of
from renderer.core.errors import InputError
from renderer.core.failure import Charted, ChartedFailure, Curve, Failure
from renderer.core.registry import phenomena
from renderer.failing import Verdict, failures, judge
from renderer.session import Session
from renderer.steadying import Plan, places, with_choice

ALL = [(scene, name, case) for scene in phenomena() for name, case in failures(scene).items()]
CASES = [(scene, name) for scene, name, case in ALL if isinstance(case, Failure)]
CHARTED = [(scene, name) for scene, name, case in ALL if isinstance(case, ChartedFailure)]


def pictured(scene: str, name: str) -> Failure:
    case = failures(scene)[name]
    assert isinstance(case, Failure)
    return case
DOCS = Path(__file__).parent.parent / "docs" / "study"


class Pretended:
    """A session of which only states are real."""

    def state(self, *arguments: Any) -> Any:
        return Session.state(self, *arguments)  # type: ignore[arg-type]

    def validate(self, document: Any) -> Any:
        return Session.validate(self, document)  # type: ignore[arg-type]

    def draw(self, state: Any, width: int, height: int, samples: int) -> Any:
        return SimpleNamespace(linear=np.full((height, width, 4), 0.5 if state.shadow.bias else 0.0, np.float32))

    def exposure_ev(self, state: Any) -> float:
        return 0.0


@pytest.fixture
def session() -> Any:
    return Pretended()


@pytest.fixture(scope="module")
def real() -> Iterator[Session]:
    with Session() as made:
        yield made


def test_there_is_a_catalogue() -> None:
    assert len(CASES) >= 12
    assert len(CHARTED) >= 5


@pytest.mark.parametrize(("scene", "name"), CASES)
def test_a_case_is_whole(session: Any, scene: str, name: str) -> None:
    case = pictured(scene, name)
    assert case.title
    assert case.cause.endswith(".")
    assert (case.symptom in ("flicker", "sway")) == bool(case.sweep)
    assert case.measured[1] <= case.threshold < case.measured[0], "its own figures are of a failure and a survivor"
    plan = Plan(scene, case.preset, case.sweep or "camera", case.slot, (), case.sets, case.width, case.steps).checked()
    both = choices_of(scene, case.slot, f"{case.failing},{case.surviving}")
    states = [with_choice(session, plan, places(session, plan)[-1], choice) for choice in both]
    assert getattr(states[0], case.slot) != getattr(states[1], case.slot)


@pytest.mark.parametrize(("scene", "name"), CHARTED)
def test_a_charted_case_is_whole(session: Any, scene: str, name: str) -> None:
    case = failures(scene)[name]
    assert isinstance(case, ChartedFailure)
    assert case.title
    assert case.cause.endswith(".")
    assert case.measured[1] <= case.threshold < case.measured[0]
    assert case.failing != case.surviving
    assert failing.opened(session, scene, case)["state"] is None, "there is no picture of it"
    assert failing.picture_name(case) == f"{name}.png"


@pytest.mark.parametrize("scene", sorted({scene for scene, _, _ in ALL}))
def test_what_is_kept_of_each_case_still_holds(scene: str) -> None:
    """Numbers and picture of every case lie in the documentation."""
    folder = DOCS / scene / "failures"
    kept = {one["name"]: one for one in json.loads((folder / "results.json").read_text(encoding="utf-8"))}
    for name, case in failures(scene).items():
        assert failing.document(case, kept[name])["holds"], name
        assert (folder / failing.picture_name(case)).is_file(), name


def test_a_charted_case_is_measured_and_drawn(session: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    place = np.arange(1.0, 4.0)
    curves = (Curve("truth", place, place), Curve("failing", place, 2 * place), Curve("surviving", place, place))
    monkeypatch.setattr(failing, "charted", lambda case: Charted(0.5, 0.001, curves, "x", "y", "xy"))
    scene, name = CHARTED[0]
    found = judge(session, scene, name)
    assert (found.failing, found.surviving, found.holds) == (0.5, 0.001, True)
    picture = np.asarray(Image.open(io.BytesIO(found.picture)).convert("RGB")).astype(int)
    reddish = (picture[..., 0] - picture[..., 2] > 100).mean()
    bluish = (picture[..., 2] - picture[..., 0] > 100).mean()
    assert reddish > 1e-3
    assert bluish > 1e-3


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


def test_a_case_keeps_its_numbers_and_its_picture(
    session: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pretend(monkeypatch, 0.9)
    (tmp_path / "results.json").write_text(json.dumps([{"name": "older", "failing_now": 1}]))
    failing.keep(tmp_path, [judge(session, "forest", "depth_map_shades_itself")], {"cores": 2})
    older, kept = json.loads((tmp_path / "results.json").read_text())
    assert older["name"] == "older", "what else was measured stays"
    assert (kept["failing_now"], kept["holds"], kept["machine"]) == (pytest.approx(0.9), True, {"cores": 2})
    picture = np.asarray(Image.open(tmp_path / "depth_map_shades_itself.jpg"))
    width, height = failing.LITTLE
    assert picture.shape == (height, 2 * width, 3)
    assert picture[:, : width - 8].mean() < 5 < 50 < picture[:, width + 8 :].mean(), "what fails is on the left"


def test_what_flickers_is_pictured_on_one_scale(session: Any) -> None:
    case = pictured("forest", "depth_map_scintillates")
    exact = [SimpleNamespace(linear=np.ones((27, 48, 4)))] * 2

    def shown(change: float) -> Any:
        return None, [np.ones((27, 48, 4)), np.full((27, 48, 4), 1 + change)]

    picture = Image.open(io.BytesIO(failing._picture(session, case, [shown(0.4), shown(-0.1)], exact)))
    left, right = np.asarray(picture)[80, [100, -100]].astype(int)
    assert left[0] > left[2] + 60, "brighter is red"
    assert 20 < right[2] - right[0] < left[0] - left[2], "darker is blue, and less of it paler"


@pytest.mark.parametrize(("symptom", "expected"), [("error", 0.5), ("stains", 0.25), ("sway", 0.25 / 1.125)])
def test_the_number_of_a_case_is_its_symptoms(symptom: Any, expected: float) -> None:
    exact, picture = (np.array([row])[..., None] * np.ones(4) for row in ([0.5, 0.5, 1.5, 1.5], [1.5, 0.5, 1.5, 1.5]))
    case = replace(pictured("forest", "depth_map_shades_itself"), symptom=symptom)
    truths: Any = [SimpleNamespace(linear=exact)] * 2
    assert failing.symptom(case, [picture, exact], truths) == pytest.approx(expected)


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
