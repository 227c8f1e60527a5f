"""Studies a scene: every combination of techniques against the reference, over suns and presets."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import renderer
from renderer.benching import COMBINATION, MOVES, Stopwatch, state_of
from renderer.comparing import converged, reference, truth
from renderer.core.baking import bake_key
from renderer.core.cache import key_of
from renderer.core.channel import Progress
from renderer.core.registry import SHADERS, phenomenon, techniques
from renderer.study.charts import write
from renderer.study.sweep import FRAMES, Case, Drawn, append, clock, provenance, sweep
from renderer.study.yardstick import Yardstick
from renderer.study_plan import EXACT, Plan, kinds_of, light_of
from renderer.truth import Judge, code_of, truth_bake
from renderer.world.state import SceneState

if TYPE_CHECKING:
    from renderer.session import Session

Tell = Callable[[float, str], None]

TIMED_SIZE = (512, 512)

PASSES = 64
"""Times that each position of a picture is drawn: four times as often as for the page's comparisons, or the sampling
noise that is left would count as an error of the best methods (0.03 of the mean at 16)."""

FEWER_PASSES: Mapping[str, int] = {"shells": 4}
"""The same for scenes whose samples differ little at one position."""


@dataclass
class Study:
    """One study under way: draws pictures and references, and remembers the last of each.

    Attributes:
        session: draws, bakes and caches.
        plan: checked.
        tell: told of what goes on inside a case.
    """

    session: Session
    plan: Plan
    tell: Tell | None = None
    _pictures: dict[str, Drawn] = field(default_factory=dict)
    _truths: dict[str, Drawn] = field(default_factory=dict)

    @property
    def passes(self) -> int:
        """Times that each position is drawn."""
        return FEWER_PASSES.get(self.plan.scene, PASSES)

    def cases(self) -> Iterator[Case]:
        """Every case; those that share a reference are neighbours."""
        kinds = [tuple(kinds_of(self.plan.scene, slot)) for slot in self.plan.slots]
        for preset, sun in itertools.product(self.plan.presets, self.plan.suns):
            chosen = [dict(zip(self.plan.slots, combination, strict=True)) for combination in itertools.product(*kinds)]
            if self.plan.judge == "combination" and "light" in self.plan.slots:
                # what a light technique alone costs: the reference with that light
                exact = [
                    {slot: light if slot == "light" else EXACT for slot in self.plan.slots}
                    for light in techniques(self.plan.scene, "light")
                ]
                chosen += [c for c in exact if self._differs(Case(preset, sun, c, light_of(sun)))]
            lights = {c["light"] for c in chosen if "light" in c}
            lit = {light: Case(preset, sun, {"light": light}, light_of(sun)) for light in lights}
            truths = {light: self._bake(case, "shadow") for light, case in lit.items()}
            for combination in sorted(chosen, key=lambda c: truths.get(c.get("light", ""), "")):
                yield Case(preset, sun, combination, light_of(sun))

    def draw(self, case: Case) -> Drawn:
        """The converged picture of a case."""
        if EXACT in case.techniques.values():
            return self._reference(case, "shadow")
        state = self._state(case)
        name = state.model_dump_json(warnings=False)
        if name not in self._pictures:
            self._pictures[name] = converged(self.session, state, self.plan.size, self.plan.size, self.passes)
        return self._pictures[name]

    def truth(self, case: Case) -> Drawn:
        """Its reference."""
        return self._reference(case, self.plan.judge)

    def fingerprint(self, case: Case) -> str:
        """Changes when the picture or its reference may: with a shader, the code that draws, or anything baked."""
        state = self._state(case)
        here = Path(renderer.__path__[0])
        code = code_of(SHADERS, here / self.plan.scene, here / "world", here / "gl")
        bakes = [bake_key(bake) for bake in phenomenon(self.plan.scene).bakes(state)]
        return key_of(code, bakes, self._bake(case, self.plan.judge), state.model_dump(mode="json"), self.passes)

    def _differs(self, case: Case) -> bool:
        """Whether the picture's own light is another than the reference's, whichever sky both have."""
        return self._bake(case, "shadow") not in (self._bake(case, "share"), self._bake(case, "combination"))

    def _bake(self, case: Case, judge: Judge) -> str:
        return bake_key(truth_bake(self._state(case), self.plan.size, self.plan.size, judge))

    def _state(self, case: Case) -> SceneState:
        drawn = {slot: kind for slot, kind in case.techniques.items() if kind != EXACT}
        return state_of(self.session, self.plan.scene, replace(case, techniques=drawn))

    def _reference(self, case: Case, judge: Judge) -> Drawn:
        state = self._state(case)
        name = self._bake(case, judge) + state.view.model_dump_json()
        if name not in self._truths:
            found = truth(self.session, state, self.plan.size, self.plan.size, judge, self._inner)
            self._truths[name] = reference(found, state.view, self.session.exposure_ev(state))
        return self._truths[name]

    def _inner(self, progress: Progress) -> None:
        if self.tell is not None:
            self.tell(progress.fraction, progress.words)


def measure_errors(
    study: Study, results: Path, machine: Mapping[str, Any], progress: Tell | None = None
) -> list[dict[str, Any]]:
    """The error of every case of a study; one that was stopped goes on where it was."""
    return sweep(results, list(study.cases()), study.draw, study.truth, study.fingerprint, machine, progress)


def measure_times(
    session: Session,
    plan: Plan,
    results: Path,
    machine: Mapping[str, Any],
    frames: int = FRAMES,
    progress: Tell | None = None,
) -> list[dict[str, Any]]:
    """One interactive frame of every case at the first preset and sun, 512 x 512, timed in turns in one run.

    Named combinations are timed at every preset, first with the sun moving, then with the camera moving.

    Args:
        session, plan: as of the errors.
        results: JSON lines to add to.
        machine: where it runs.
        frames: timed frames of each.
        progress: told the share done.
    """
    stick = session.gl.call(Yardstick)
    watch = Stopwatch(session, plan.scene, TIMED_SIZE)
    yardstick = functools.partial(session.gl.call, stick.draw_ms)
    found = []
    try:
        for cases in _timed(session, plan):
            found += clock(results, cases, watch.frame_ms, TIMED_SIZE, machine, yardstick, frames, progress)
    finally:
        watch.close()
    return found


def _timed(session: Session, plan: Plan) -> Iterator[list[Case]]:
    """Cases that are timed in turns: frames of a moving camera among them would push out what a moving sun leaves."""
    named = plan.slots == (COMBINATION,)
    for what in MOVES[1:] if named else MOVES[:1]:
        for preset in plan.presets if named else plan.presets[:1]:
            first = replace(plan, presets=(preset,), suns=plan.suns[:1], judge="shadow")
            cases = Study(session, first).cases()
            yield [replace(case, parameters={**case.parameters, "moves": what}) for case in cases]


def run(
    session: Session,
    plan: Plan,
    folder: Path,
    frames: int = FRAMES,
    tell: Tell | None = None,
    inner: Tell | None = None,
) -> None:
    """Run a study for both judgements, and write raw results, tables and charts.

    Each picture is drawn once and each reference computed once, though both judgements need most of them.

    Args:
        session: draws, bakes and caches.
        plan: checked; its `judge` does not matter.
        folder: gets the results against the full reference; its folder `shadow` those against exact shadows under the
            picture's own light.
        frames: timed frames of each combination; 0 for no times.
        tell, inner: told of the share done, and of what goes on within a case.
    """
    machine = provenance(session.gl.info.renderer)
    study = Study(session, plan, inner)
    times: list[dict[str, Any]] = []
    for judge, home in plan.judged.items():
        study.plan = replace(plan, judge=judge)
        results = folder / home / "results.jsonl"
        lines = measure_errors(study, results, machine, tell)
        if frames and not times:
            times = measure_times(session, plan, results, machine, frames, tell)
        else:
            for line in times:
                append(results, line)
        _draw(folder / home, study.plan, machine, lines)


def _draw(home: Path, plan: Plan, machine: Mapping[str, Any], lines: list[dict[str, Any]]) -> None:
    """Table and chart of one judgement, from the results of this plan alone."""
    suns = f"{len(plan.suns)} suns" if len(plan.suns) > 1 else "one sun"
    title = f"{plan.scene}, {plan.judge}: {suns}, {', '.join(plan.presets)}, {plan.size} px, {machine['renderer']}"
    keys = {line["key"] for line in lines}
    marker = "geometry" if "geometry" in plan.slots and plan.slots[0] != "geometry" else ""
    write(
        home / "results.jsonl",
        home,
        title,
        plan.slots[0],
        marker,
        lambda line: line["kind"] == "time" or line["key"] in keys,
    )
