"""What the techniques of a table of shadow kinds cost: frames in turns, bytes, and what is baked."""

from __future__ import annotations

import functools
import importlib
import json
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from renderer.benching import MOVES, Stopwatch
from renderer.core.baking import bake_key, bake_now
from renderer.core.registry import phenomenon
from renderer.core.technique import Arrays, Bake
from renderer.kind_study import THRESHOLD, KindStudy, Plan, state_with
from renderer.study.kinds import write
from renderer.study.sweep import Case, append, clock, provenance, read
from renderer.study.yardstick import Yardstick
from renderer.world.state import SceneState

if TYPE_CHECKING:
    from renderer.session import Session

Tell = Callable[[float, str], None]

TIMED_SIZE = (512, 512)

TIMED = "combined"
"""View in which frames are timed."""

RAW = "raw.jsonl"
"""Raw results of one table, where `results.jsonl` keeps those of every earlier one too."""

NAME = "contender"
"""Stands for the slots in a timed case."""


def measure_times(
    session: Session, plan: Plan, results: Path, machine: Mapping[str, Any], frames: int, tell: Tell | None = None
) -> list[dict[str, Any]]:
    """One interactive frame of every contender, in turns in one run, while the sun moves.

    Args:
        session: draws. plan: checked.
        results: JSON lines to add to. machine: where it runs.
        frames: timed frames of each.
        tell: told the share done.
    """
    preset = next(one.preset for one in plan.isolations if one.name == TIMED)
    known = {one.label: one for one in plan.contenders}
    states = {label: _timed(session, state_with(session, plan, preset, one)) for label, one in known.items()}
    stick = session.gl.call(Yardstick)
    watch = Stopwatch(session, plan.scene, TIMED_SIZE, lambda case: states[case.techniques[NAME]])
    yardstick = functools.partial(session.gl.call, stick.draw_ms)
    cases = [Case(preset, "preset", {NAME: label}, {"moves": MOVES[1]}) for label in states]
    try:
        return clock(results, cases, watch.frame_ms, TIMED_SIZE, machine, yardstick, frames, tell)
    finally:
        watch.close()


def _timed(session: Session, state: SceneState) -> SceneState:
    """A state of which each frame draws one sample."""
    return session.validate({**state.model_dump(mode="json"), "quality": {"kind": "samples", "n": 4096}})


def measure_bytes(
    session: Session, plan: Plan, results: Path, machine: Mapping[str, Any], tell: Tell | None = None
) -> list[dict[str, Any]]:
    """What each contender keeps on the GPU, and what was baked for it: bytes, and processor seconds of each bake.

    A bake is computed afresh in this process; its inputs are taken from the cache. A bake that two contenders share
    counts for each.
    """
    preset = next(one.preset for one in plan.isolations if one.name == TIMED)
    held = importlib.import_module(f"renderer.{plan.scene}.isolating").held_bytes
    baked = {line["key"]: line for line in read(results) if line["kind"] == "bake"}
    found = []
    for number, contender in enumerate(plan.contenders):
        if tell is not None:
            tell(number / len(plan.contenders), f"what {contender.label} bakes and holds")
        state = state_with(session, plan, preset, contender)
        lines = []
        for bake in _own(state):
            key = bake_key(bake)
            if key not in baked:
                baked[key] = {"kind": "bake", "key": key, **_baked(session, bake), "machine": dict(machine),
                              "when": int(time.time())}  # fmt: skip
                append(results, baked[key])
            lines.append(baked[key])
        arrays = {bake.name: bake_now(bake, session.cache) for bake in phenomenon(plan.scene).bakes(state)}
        line = {"kind": "bytes", "label": contender.label, "size": list(TIMED_SIZE),
                "held_bytes": held(state, arrays, TIMED_SIZE),
                "baked_bytes": sum(one["bytes"] for one in lines),
                "bake_seconds": sum(one["processor_seconds"] for one in lines),
                "machine": dict(machine), "when": int(time.time())}  # fmt: skip
        append(results, line)
        found.append(line)
    return found


def _own(state: SceneState) -> Iterator[Bake]:
    """Bakes of a state's techniques: the others make the world, which every technique needs."""
    found = phenomenon(state.scene)
    yield from (bake for bake in found.bakes(state) if bake.name not in found.world_needs)


def _baked(session: Session, bake: Bake) -> dict[str, Any]:
    """Time and size of one bake."""
    inputs: dict[str, Arrays] = {source.name: bake_now(source, session.cache) for source in bake.inputs}
    begun, spent = time.perf_counter(), time.process_time()
    arrays = bake.function(bake.arguments, inputs, lambda share, words: None)
    spent, begun = time.process_time() - spent, time.perf_counter() - begun
    size = sum(array.nbytes for array in arrays.values())
    return {"name": bake.name, "arguments": bake.arguments, "processor_seconds": spent, "seconds": begun, "bytes": size}


def run(session: Session, plan: Plan, folder: Path, frames: int, tell: Tell | None = None) -> None:
    """Measure a table of shadow kinds and write its raw results, table and chart.

    Args:
        session: draws, bakes and caches.
        plan: checked.
        folder: gets `results.jsonl`, `raw.jsonl`, `table.md`, and `speed_accuracy` as `.png`, `.svg` and `.csv`.
        frames: timed frames of each technique; 0 for no times.
        tell: told the share done.
    """
    machine = provenance(session.gl.info.renderer)
    results = folder / "results.jsonl"
    study = KindStudy(session, plan, tell)
    lines = [*study.masks(results, machine), *study.measure(results, machine)]
    lines += measure_bytes(session, plan, results, machine, tell)
    if frames:
        lines += measure_times(session, plan, results, machine, frames, tell)
    view = next(one for one in plan.isolations if one.name == TIMED)
    title = (
        f"{plan.scene}, kinds of shadow: {plan.size} px, flicker of {plan.steps} steps at {plan.moving} px; "
        f"{machine['renderer']}, {machine['cores']} cores, {machine['commit'][:9]}"
    )
    notes = (
        "Each cell: relative RMSE / mean FLIP / flicker, over the pixels that the kind's shadow, cast alone, changes "
        f"by more than {THRESHOLD:.0%} of the unshadowed picture's mean; `{TIMED}` over all of `{view.preset}`. Shadow "
        "techniques stand on exact leaf light and rays too fine to err, and are judged against exact shadows; "
        "combinations have their own light, and are judged against leaves' own. Frames are of "
        f"{TIMED_SIZE[0]} x {TIMED_SIZE[1]} pixels, the sun moving."
    )
    write(lines, folder, title, notes)
    text = "".join(json.dumps(line, sort_keys=True) + "\n" for line in lines)
    (folder / RAW).write_text(text, encoding="utf-8")
