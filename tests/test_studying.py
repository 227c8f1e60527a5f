"""Plans of studies and benchmarks, and a whole study over made-up pictures."""

from __future__ import annotations

import itertools
import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer import benching, studying
from renderer.core.errors import InputError
from renderer.core.registry import techniques
from renderer.session import Session
from renderer.study.sweep import Case, Drawn, read
from renderer.study_plan import EXACT, SLOTS, SUNS, Plan, light_of
from renderer.studying import Study

KINDS = {slot: tuple(techniques("forest", slot)) for slot in SLOTS}
COMBINATIONS = math.prod(len(kinds) for kinds in KINDS.values())
OWN_LIGHT = ("gouraud", "lambert")
"""Lights that the reference has beside its own."""
ERRORS = {kind: 0.1 if kind == "double_horizon_map" else 0.4 for kind in KINDS["shadow"]}


class Pretended:
    """A session of which only states are real."""

    def __init__(self) -> None:
        self.gl = SimpleNamespace(info=SimpleNamespace(renderer="pretended"))
        self.shown: list[Any] = []

    def state(self, *arguments: Any, **named: Any) -> Any:
        return Session.state(self, *arguments, **named)  # type: ignore[arg-type]

    def prepared(self, state: Any) -> bool:
        return True

    def exposure_ev(self, state: Any) -> float:
        return 0.0

    def view(self) -> Any:
        def frame(state: Any, width: int, height: int) -> Any:
            self.shown.append(state)
            return SimpleNamespace(result=lambda: SimpleNamespace(render_ms=7.0))

        return SimpleNamespace(frame=frame, close=lambda: None)


def flat(value: float) -> Drawn:
    linear = np.full((16, 16, 4), value)
    return Drawn(linear, np.full((16, 16, 3), min(255, round(100 * value)), np.uint8), linear, 1.0, 0.01)


@pytest.fixture
def session() -> Any:
    return Pretended()


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"presets": ("nope",)}, "presets"),
        ({"suns": ("moon",)}, "suns"),
        ({"slots": ("hat",)}, "slots"),
        ({"size": 1}, "size"),
    ],
)
def test_a_wrong_plan_names_its_option(changes: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as refused:
        Plan("forest", **changes).checked()
    assert refused.value.field == field


def test_every_combination_is_there_once_and_neighbours_share_a_reference(session: Any) -> None:
    study = Study(session, Plan("forest", ("noon",), tuple(SUNS)[:2]).checked())
    cases = list(study.cases())
    combined = [case for case in cases if EXACT not in case.techniques.values()]
    assert len(combined) == len({repr(case) for case in combined}) == 2 * COMBINATIONS
    exact = [case.techniques for case in cases if case not in combined]
    assert sorted(case["light"] for case in exact) == sorted(2 * OWN_LIGHT)
    assert all(case["shadow"] == case["geometry"] == EXACT for case in exact)
    study.plan = Plan("forest", ("noon",), tuple(SUNS)[:2], judge="shadow").checked()
    keys = [study._bake(case, "shadow") for case in study.cases()]
    changes = sum(a != b for a, b in itertools.pairwise(keys))
    assert changes == len(set(keys)) - 1 == 2 * (len(OWN_LIGHT) + 1) - 1


def test_two_dozen_suns_differ(session: Any) -> None:
    cases = [Case("noon", sun, {}, light_of(sun)) for sun in SUNS]
    states = [benching.state_of(session, "forest", case) for case in cases]
    assert len({state.sun.model_dump_json() for state in states}) == 24
    assert {state.sun.elevation for state in states} == {elevation for _, elevation in SUNS.values()}


def test_a_fingerprint_follows_what_is_drawn(session: Any) -> None:
    study = Study(session, Plan("forest", ("noon",)).checked())
    light = light_of(next(iter(SUNS)))
    prints = [study.fingerprint(Case("noon", "a", {"shadow": kind}, light)) for kind in ("none", "horizon_map")]
    assert prints[0] != prints[1]
    assert prints[0] == study.fingerprint(Case("noon", "renamed", {"shadow": "none"}, light))


def test_a_study_leaves_results_tables_and_charts(
    session: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Any] = []

    def converged(session: Any, state: Any, width: int, height: int, passes: int) -> Drawn:
        drawn.append(state)
        return flat(1 + ERRORS[state.shadow.kind] + (0.01 if state.light.kind == "gouraud" else 0))

    monkeypatch.setattr(studying, "converged", converged)
    monkeypatch.setattr(studying, "truth", lambda session, state, width, height, judge, report: (state, judge))
    monkeypatch.setattr(
        studying,
        "reference",
        lambda found, view, exposure_ev: flat(
            1.01 if found[1] == "shadow" and found[0].light.kind == "gouraud" else 1.0
        ),
    )
    plan = Plan("forest", ("noon",), tuple(SUNS)[:2], size=16).checked()
    told: list[float] = []
    studying.run(session, plan, tmp_path, 0, lambda share, words: told.append(share))
    assert len(drawn) == 2 * COMBINATIONS, "each picture is drawn once for both judgements"
    for folder, gouraud in ((tmp_path, 0.11), (tmp_path / "shadow", 0.1 / 1.01)):
        lines = read(folder / "results.jsonl")
        assert {line["machine"]["renderer"] for line in lines} == {"pretended"}
        best = [line for line in lines if line["techniques"].get("shadow") == "double_horizon_map"]
        errors = {line["techniques"]["light"]: line["relative_rmse"] for line in best}
        assert errors == pytest.approx({kind: gouraud if kind == "gouraud" else 0.1 for kind in KINDS["light"]})
        table = (folder / "table.md").read_text()
        assert "2 suns, noon, 16 px, pretended" in table
        assert table.count("double_horizon_map") == COMBINATIONS // len(KINDS["shadow"])
        assert {"speed_accuracy.svg", "speed_accuracy.png", "speed_accuracy.csv"} <= {p.name for p in folder.iterdir()}
    exact = [line for line in read(tmp_path / "results.jsonl") if EXACT in line["techniques"].values()]
    assert [line["relative_rmse"] for line in exact if line["techniques"]["light"] == "gouraud"] == pytest.approx(
        [0.01, 0.01]
    )
    studying.run(session, plan, tmp_path, 0)
    assert len(drawn) == 2 * COMBINATIONS, "what is known is not drawn again"


def test_variants_differ_from_the_default_in_one_slot() -> None:
    default, *others = benching.variants("forest")
    assert all(sum(other[slot] != default[slot] for slot in default) == 1 for other in others)
    assert {other["shadow"] for other in others} == set(ERRORS)


def test_a_stopwatch_draws_single_frames_of_what_moves(session: Any) -> None:
    watch = benching.Stopwatch(session, "forest", (64, 64))
    techniques = benching.variants("forest")[0]
    for moves in benching.MOVES:
        session.shown.clear()
        times = [watch.frame_ms(Case("noon", "preset", techniques, {"moves": moves})) for _ in range(3)]
        assert times == [7.0] * 3
        suns = [state.sun.azimuth for state in session.shown]
        cameras = [state.camera.azimuth for state in session.shown]
        for name, azimuths in (("sun", suns), ("camera", cameras)):
            step = benching.STEP_DEGREES if name == moves else 0.0
            # three timed, after one that is not: what a case keeps is drawn first
            assert np.diff(azimuths) == pytest.approx([step] * 3)


def test_every_preset_has_a_picture_under_three_suns(session: Any) -> None:
    suns = {benching.pictured(session, "forest", "noon", sun).sun.model_dump_json() for sun in benching.SUNS}
    assert len(suns) == 3
