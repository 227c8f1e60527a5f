"""The failure catalogue: the cases of every scene, and what they measure today.

A phenomenon lists its cases in `renderer/<name>/failures.py`, as `FAILURES`; nothing else changes for a new one.
"""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from renderer.choices import choices_of
from renderer.comparing import converged, truth
from renderer.core.errors import InputError
from renderer.core.failure import Failure
from renderer.core.registry import phenomenon
from renderer.steadying import Plan, places, with_choice
from renderer.study.metrics import relative_rmse
from renderer.study.stability import flicker
from renderer.truth import Truth

if TYPE_CHECKING:
    from renderer.session import Session

Tell = Callable[[float, str], None]


@dataclass(frozen=True)
class Verdict:
    """What a case measures today.

    Attributes:
        failure: the case. failing, surviving: the symptom of either.
    """

    failure: Failure
    failing: float
    surviving: float

    @property
    def holds(self) -> bool:
        """Whether the one still fails and the other still survives."""
        return self.surviving <= self.failure.threshold < self.failing

    def document(self) -> dict[str, Any]:
        """As JSON values."""
        return {
            **asdict(self.failure),
            "failing_now": self.failing,
            "surviving_now": self.surviving,
            "holds": self.holds,
        }


def failures(scene: str) -> dict[str, Failure]:
    """The cases of a scene by name; none where it has no catalogue.

    Raises:
        InputError: there is no such scene.
    """
    name = f"renderer.{phenomenon(scene).name}.failures"
    if importlib.util.find_spec(name) is None:
        return {}
    return {case.name: case for case in importlib.import_module(name).FAILURES}


def judge(session: Session, scene: str, name: str, tell: Tell | None = None) -> Verdict:
    """Measure both techniques of a case; their references are shared.

    Raises:
        InputError: the scene has no such case.
    """
    known = failures(scene)
    if name not in known:
        raise InputError("failure", f"{scene} has no such case", ", ".join(known))
    case = known[name]
    steps = case.steps if case.symptom == "flicker" else 1
    plan = Plan(scene, case.preset, case.sweep or "camera", case.slot, (), case.sets, case.width, steps).checked()
    states = places(session, plan)[: 1 if case.symptom == "error" else None]
    truths: list[Truth] = []
    found = []
    for choice in choices_of(scene, case.slot, f"{case.failing},{case.surviving}"):
        drawn = [with_choice(session, plan, state, choice) for state in states]
        for turn, state in enumerate(drawn[len(truths) :]):
            if tell is not None:
                tell(0.5 * turn / len(drawn), f"{name}: reference {turn + 1} of {len(drawn)}")
            truths.append(truth(session, state, *plan.size, "shadow"))
        found.append(_symptom(session, case, plan, drawn, truths))
    return Verdict(case, *found)


def _symptom(session: Session, case: Failure, plan: Plan, states: list[Any], truths: list[Truth]) -> float:
    pictures = [converged(session, state, *plan.size).linear for state in states]
    if case.symptom == "error":
        return relative_rmse(pictures[0][..., :3], truths[0].linear[..., :3])
    return flicker(pictures, [one.linear for one in truths]).value
