"""The failure catalogue: the cases of every scene, and what they measure today.

A phenomenon lists its cases in `renderer/<name>/failures.py`, as `FAILURES`; nothing else changes for a new one.
"""

from __future__ import annotations

import importlib
import importlib.util
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.choices import Choice, choices_of
from renderer.comparing import converged, displayed, truth
from renderer.core.errors import InputError
from renderer.core.failure import Charted, ChartedFailure, Failure
from renderer.core.registry import phenomenon, techniques
from renderer.steadying import Plan, places, with_choice
from renderer.study.failure_chart import failure_chart
from renderer.study.metrics import relative_rmse, stained
from renderer.study.stability import changes, flicker
from renderer.truth import Judge, Truth
from renderer.world.image import save_image
from renderer.world.state import SceneState

if TYPE_CHECKING:
    from renderer.session import Session

Tell = Callable[[float, str], None]
Case = Failure | ChartedFailure

LITTLE = (288, 162)
"""Width and height of either half of a case's picture."""


@dataclass(frozen=True)
class Verdict:
    """What a case measures today.

    Attributes:
        failure: the case. failing, surviving: the symptom of either.
        picture: JPEG of both side by side: the pictures, or what flickers in their worst step, brighter in red; of a
            case that has none, the PNG of its chart.
    """

    failure: Case
    failing: float
    surviving: float
    picture: bytes = field(default=b"", repr=False)

    @property
    def holds(self) -> bool:
        """Whether the one still fails and the other still survives."""
        return self.surviving <= self.failure.threshold < self.failing

    def document(self) -> dict[str, Any]:
        """As JSON values."""
        return document(self.failure, {"failing_now": self.failing, "surviving_now": self.surviving})


def document(case: Case, measured: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """A case as JSON values, with what was measured of it since it was written, if anything."""
    found = {**asdict(case), **dict.fromkeys(NOW), "holds": None}
    if measured is not None:
        failing, surviving = (float(measured[name]) for name in NOW)
        found |= {NOW[0]: failing, NOW[1]: surviving, "holds": surviving <= case.threshold < failing}
    return found


def keep(folder: Path, verdicts: Sequence[Verdict], machine: Mapping[str, Any]) -> None:
    """Write what was measured into `results.json`, beside what it holds of other cases, and each case's picture."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "results.json"
    known = {one["name"]: one for one in json.loads(path.read_text(encoding="utf-8"))} if path.is_file() else {}
    for verdict in verdicts:
        name = verdict.failure.name
        known[name] = {**verdict.document(), "machine": dict(machine)}
        (folder / picture_name(verdict.failure)).write_bytes(verdict.picture)
    path.write_text(json.dumps(list(known.values()), indent=1), encoding="utf-8")


def picture_name(case: Case) -> str:
    """The file that shows a case."""
    return f"{case.name}.{'png' if isinstance(case, ChartedFailure) else 'jpg'}"


NOW = ("failing_now", "surviving_now")
"""Names of what was measured last."""


def failures(scene: str) -> dict[str, Case]:
    """The cases of a scene by name; none where it has no catalogue.

    Raises:
        InputError: there is no such scene.
    """
    name = f"renderer.{phenomenon(scene).name}.failures"
    if importlib.util.find_spec(name) is None:
        return {}
    return {case.name: case for case in importlib.import_module(name).FAILURES}


def plan_of(scene: str, case: Failure) -> Plan:
    """The sweep of a case; of a still one the first place alone counts."""
    steps = case.steps if case.sweep else 1
    sweep = case.sweep or "camera"
    return Plan(scene, case.preset, sweep, case.slot, (), case.sets, case.width, steps, case.stride).checked()


def choices_in(scene: str, case: Failure) -> tuple[Choice, ...]:
    """The technique that fails and the one that survives."""
    return choices_of(scene, case.slot, f"{case.failing},{case.surviving}")


def opened(session: Any, scene: str, case: Case) -> dict[str, Any]:
    """A case as a viewer opens it; one that has a chart has no state.

    Args:
        session: of which `state` and `validate` are asked.

    Returns:
        `state`, where it fails; `patch`, which makes that the surviving one; `words` for either technique; and `moves`,
        a merge patch for each further place of its sweep.
    """
    if isinstance(case, ChartedFailure):
        return {"state": None, "patch": None, "words": [case.failing, case.surviving], "moves": []}
    plan = plan_of(scene, case)
    states = places(session, plan)[: None if case.sweep else 1]
    pair = choices_in(scene, case)
    failing, surviving = (with_choice(session, plan, states[0], choice).model_dump(mode="json") for choice in pair)
    documents = [state.model_dump(mode="json") for state in states]
    moves = [{name: value for name, value in one.items() if value != documents[0][name]} for one in documents[1:]]
    known = techniques(scene, case.slot)
    words = [
        ", ".join([known[one.kind].title, *(_in_words(name, value) for name, value in one.parameters.items())])
        for one in pair
    ]
    return {"state": failing, "patch": {case.slot: surviving[case.slot]}, "words": words, "moves": moves}


def _in_words(name: str, value: Any) -> str:
    """A parameter as a reader of the page takes it."""
    return f"{name.replace('_', ' ')} {({True: 'on', False: 'off'})[value] if isinstance(value, bool) else value}"


def judge(session: Session, scene: str, name: str, tell: Tell | None = None) -> Verdict:
    """Measure both techniques of a case; their references are shared.

    Raises:
        InputError: the scene has no such case.
    """
    known = failures(scene)
    if name not in known:
        raise InputError("failure", f"{scene} has no such case", ", ".join(known))
    case = known[name]
    if isinstance(case, ChartedFailure):
        if tell is not None:
            tell(0.0, name)
        numbers = charted(case)
        return Verdict(case, numbers.failing, numbers.surviving, failure_chart(case, numbers))
    return _judged(session, scene, case, tell)


def charted(case: ChartedFailure) -> Charted:
    """What a case without a picture measures."""
    module, _, name = case.measure.partition(":")
    found: Charted = getattr(importlib.import_module(module), name)()
    return found


def _judged(session: Session, scene: str, case: Failure, tell: Tell | None) -> Verdict:
    plan = plan_of(scene, case)
    states = places(session, plan)[: None if case.sweep else 1]
    against: Judge = "combination" if case.slot == "light" else "shadow"
    truths: list[Truth] = []
    found, shown = [], []
    for choice in choices_in(scene, case):
        drawn = [with_choice(session, plan, state, choice) for state in states]
        for turn, state in enumerate(drawn[len(truths) :]):
            if tell is not None:
                tell(0.5 * turn / len(drawn), f"{case.name}: reference {turn + 1} of {len(drawn)}")
            truths.append(truth(session, state, *plan.size, against))
        pictures = [converged(session, state, *plan.size).linear for state in drawn]
        found.append(symptom(case, pictures, truths))
        shown.append((drawn[0], pictures))
    return Verdict(case, found[0], found[1], _picture(session, case, shown, truths))


def symptom(case: Failure, pictures: list[np.ndarray], truths: list[Truth]) -> float:
    """The number of a case."""
    exact = [one.linear for one in truths]
    if case.symptom == "flicker":
        return flicker(pictures, exact).value
    if case.symptom == "sway":
        ratios = [picture[..., :3].mean() / one[..., :3].mean() for picture, one in zip(pictures, exact, strict=True)]
        return float(np.ptp(ratios) / np.mean(ratios))
    return {"error": relative_rmse, "stains": stained}[case.symptom](pictures[0], exact[0])


def _picture(
    session: Session, case: Failure, shown: list[tuple[SceneState, list[np.ndarray]]], truths: list[Truth]
) -> bytes:
    """What fails beside what survives."""
    if case.symptom == "flicker":
        exact = [one.linear for one in truths]
        halves = changes([flicker(pictures, exact) for _, pictures in shown], LITTLE[0])
    else:
        halves = [_still(session, state) for state, _ in shown]
    return save_image("jpeg", np.concatenate(halves, axis=1))


def _still(session: Session, state: SceneState) -> np.ndarray:
    picture = session.draw(state, *LITTLE, 16)
    return displayed(picture.linear, state.view, session.exposure_ev(state))
