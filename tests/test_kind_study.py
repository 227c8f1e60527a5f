"""A table of shadow kinds over a made-up world whose errors and flicker are known."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from renderer import kind_costs, kind_study
from renderer.core.errors import InputError, LimitError
from renderer.core.isolation import Contender
from renderer.kind_study import KindStudy, Plan
from renderer.session import Session
from renderer.study.sweep import read
from renderer.truth_scenes import FOREST_SHADOWS
from renderer.world.sun import angles

MACHINE = {"renderer": "pretended", "cores": 2, "commit": "abc"}
SIZE, MOVING, STEPS = 16, 24, 3
DARK = 0.5
"""What the sun's light is cut to where a kind of shadow falls."""

CHOSEN = ("none", "sun_march", "depth_shadow_map, 512", "combination: thesis")


def shaded(cast: dict[str, bool], preset_sun: float, side: int) -> np.ndarray:
    """A quarter of the picture for each kind, dark where it is cast, and a sun that brightens all as it moves."""
    light = np.ones((side, side))
    for number, kind in enumerate(FOREST_SHADOWS):
        if cast.get(kind, True):
            light[:, number * side // 4 : (number + 1) * side // 4] = DARK
    return np.repeat((light * (1 + 0.01 * preset_sun))[..., None], 4, axis=2)


def turned(session: Any, state: Any) -> float:
    """Steps that a state's sun has moved from its preset's; its preset is known by the camera."""
    first = next(
        made
        for one in session.isolations
        if (made := session.state("forest", one.preset)).camera.model_dump() == state.camera.model_dump()
    )
    return round((math.degrees(angles(state.sun)[0] - angles(first.sun)[0])) / 0.25)


class Pretended:
    """A session of which only states are real: `none` sees no shadow, `sun_march` all, a depth map flickers."""

    def __init__(self) -> None:
        self.gl = SimpleNamespace(info=SimpleNamespace(renderer="pretended"))
        self.isolations = Plan("forest").isolations
        self.drawn: list[str] = []
        self.broken = ""

    def state(self, *arguments: Any, **named: Any) -> Any:
        return Session.state(self, *arguments, **named)  # type: ignore[arg-type]

    def validate(self, document: Any) -> Any:
        return Session.validate(self, document)  # type: ignore[arg-type]

    def exposure_ev(self, state: Any) -> float:
        return 0.0

    def compute(self, bake: Any, report: Any) -> Any:
        assert bake.arguments["options"]["light"] == "leaf"
        state = self.validate({**bake.arguments["state"]})
        linear = shaded(bake.arguments["options"], turned(self, state), bake.arguments["size"][0])
        return {"linear": linear, "once": linear, "backdrop": linear[..., :3], "standard_error": np.array(0.01),
                "seconds": np.array(2.0)}  # fmt: skip

    def draw(self, state: Any, width: int, height: int, samples: int, place: Any) -> Any:
        assert state.view.background == "none"
        kind, turn = state.shadow.kind, turned(self, state)
        if kind == self.broken:
            raise LimitError("resolution", "is more than this machine can draw")
        self.drawn.append(kind)
        cast = dict.fromkeys(FOREST_SHADOWS, kind != "none")
        wavers = 1 + 0.1 * (turn % 2) if kind == "depth_shadow_map" else 1.0
        return SimpleNamespace(linear=shaded(cast, turn, width) * wavers)


@pytest.fixture
def session(monkeypatch: pytest.MonkeyPatch) -> Any:
    every = Plan("forest").contenders
    few = tuple(one for one in every if one.label in CHOSEN)
    monkeypatch.setattr(Plan, "contenders", property(lambda plan: few))
    return Pretended()


def measured(session: Any, path: Path) -> dict[tuple[str, str], dict[str, Any]]:
    study = KindStudy(session, Plan("forest", SIZE, MOVING, STEPS).checked())
    return {(line["column"], line["label"]): line for line in study.measure(path, MACHINE)}


def test_errors_and_flicker_are_those_of_the_kinds_own_pixels(session: Any, tmp_path: Path) -> None:
    found = measured(session, tmp_path / "r.jsonl")
    assert len(found) == 5 * len(CHOSEN)
    for kind in ("land", "ground", "tree", "within"):
        assert found[kind, "none"]["covers"] == 0.25
        assert found[kind, "none"]["relative_rmse"] == pytest.approx((1 - DARK) / DARK)
        assert found[kind, "none"]["flip_mean"] > 0.05
    # all four quarters lie in shade, each under its own kind
    assert found["combined", "none"]["covers"] == 1.0
    assert found["combined", "none"]["relative_rmse"] == pytest.approx((1 - DARK) / DARK)
    for kind in ("land", "ground", "tree", "within", "combined"):
        march, depth = found[kind, "sun_march"], found[kind, "depth_shadow_map, 512"]
        assert march["relative_rmse"] == march["flip_mean"] == 0
        assert march["flicker"] == pytest.approx(0, abs=1e-12)
        # by turns a tenth brighter and not, of a mean that grows by a hundredth a step
        assert depth["flicker"] == pytest.approx(0.1, rel=0.02)
        assert march["truth_moves"] == pytest.approx(0.01, rel=0.02)
        assert march["size"] == [SIZE, SIZE]
        assert march["moving"] == [MOVING, MOVING]


def test_what_is_known_is_not_drawn_again_and_a_failure_is_tried_again(session: Any, tmp_path: Path) -> None:
    session.broken = "sun_march"
    failed = measured(session, tmp_path / "r.jsonl")["tree", "sun_march"]
    assert "more than this machine" in failed["failed"]
    session.broken, session.drawn = "", []
    again = measured(session, tmp_path / "r.jsonl")
    assert set(session.drawn) == {"sun_march"}
    assert again["tree", "sun_march"]["relative_rmse"] == 0
    assert len(read(tmp_path / "r.jsonl")) == 5 * (len(CHOSEN) + 1)


def test_two_names_for_the_same_techniques_are_drawn_once_and_told_twice(
    session: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    same = tuple(Contender(name, {"shadow": {"kind": "none"}}) for name in ("one", "other"))
    monkeypatch.setattr(Plan, "contenders", property(lambda plan: same))
    found = measured(session, tmp_path / "r.jsonl")
    assert {label for _, label in found} == {"one", "other"}
    assert len(read(tmp_path / "r.jsonl")) == 5


def test_a_kinds_share_is_told_among_those_that_change_its_pixels(session: Any, tmp_path: Path) -> None:
    study = KindStudy(session, Plan("forest", SIZE, MOVING, STEPS).checked())
    lines = study.masks(tmp_path / "r.jsonl", MACHINE)
    assert [line["column"] for line in lines] == ["land", "ground", "tree", "within"]
    for line in lines:
        assert line["covers"] == 0.25
        assert line["shares"] == {kind: float(kind == line["column"]) for kind in line["shares"]}


def test_shadow_techniques_share_all_but_the_shadow_and_combinations_nothing(session: Any) -> None:
    plan = Plan("forest")
    own = kind_study.state_with(session, plan, "low_sun", Contender("", {"shadow": {"kind": "double_horizon_map"}}))
    assert own.shadow.strength == 1.0, "the technique's own strength, not the default scene's"
    assert (own.height_shading.kind, own.light.kind, own.filter.kind) == ("none", "leaf", "none")
    patch = {"light": {"kind": "lambert"}}
    whole = kind_study.state_with(session, plan, "low_sun", Contender("", patch, True))
    preset = session.state("forest", "low_sun")
    assert whole.light.kind == "lambert"
    assert (whole.geometry, whole.filter) == (preset.geometry, preset.filter)


def test_a_run_leaves_its_table_and_raw_results(session: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    costs = {"held_bytes": 1_000_000, "baked_bytes": 2_000_000, "bake_seconds": 3.0}
    monkeypatch.setattr(
        kind_costs,
        "measure_bytes",
        lambda session, plan, results, machine, tell: [
            {"kind": "bytes", "label": label, "machine": machine, **costs} for label in CHOSEN
        ],
    )
    kind_costs.run(session, Plan("forest", SIZE, MOVING, STEPS).checked(), tmp_path, 0)
    text = (tmp_path / "table.md").read_text()
    assert "16 px, flicker of 3 steps at 24 px; pretended" in text
    assert "| sun_march | **0** / 0 / " in text
    assert "| none | 1 / " in text
    assert "| 1 | 2 | 3 |" in text
    assert len(read(tmp_path / "raw.jsonl")) == 4 + 5 * len(CHOSEN) + len(CHOSEN)


@pytest.mark.parametrize(
    ("changes", "field"), [({"size": 8}, "size"), ({"moving": 999}, "moving"), ({"steps": 0}, "steps")]
)
def test_a_wrong_plan_names_its_option(changes: dict[str, int], field: str) -> None:
    with pytest.raises(InputError) as refused:
        Plan("forest", **changes).checked()
    assert refused.value.field == field
