"""What each technique costs and how wrong it is, everything else at its default: the line below its caption."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from renderer.benching import MOVES, Stopwatch, variants
from renderer.core.registry import phenomenon, techniques
from renderer.study.sweep import Case, clock, provenance, sweep
from renderer.study.yardstick import Yardstick
from renderer.study_plan import Plan
from renderer.studying import TIMED_SIZE, Study

if TYPE_CHECKING:
    from renderer.session import Session

QUICKEST_OF = 40
"""Yardsticks of which the quickest stands for this machine: what else it did meanwhile is then no part of a cost."""

Tell = Callable[[float, str], None]
Lines = Sequence[Mapping[str, Any]]


def measure(
    session: Session,
    scene: str,
    folder: Path,
    size: int,
    frames: int,
    tell: Tell | None = None,
    presets: Sequence[str] = (),
) -> Path:
    """Measure every technique of every slot at each preset against the full reference, and its time.

    Args:
        session: draws, bakes and caches.
        folder: gets `results.jsonl`, which a later call goes on with, and `facts.json`.
        size: side of the pictures that are judged, pixels. frames: timed frames of each.
        tell: told the share done.
        presets: by name; none stands for all without a group.

    Returns:
        Path of `facts.json`.

    Raises:
        InputError: a size that is not studied.
    """
    errors, times, unit = measured(session, scene, folder, size, frames, tell, presets)
    return keep(folder, facts(scene, errors, times, size, unit))


def keep(folder: Path, found: Mapping[str, Any]) -> Path:
    """Write `facts.json`, and return its path."""
    path = folder / "facts.json"
    path.write_text(json.dumps(found, indent=1), encoding="utf-8")
    return path


def measured(
    session: Session,
    scene: str,
    folder: Path,
    size: int,
    frames: int,
    tell: Tell | None = None,
    presets: Sequence[str] = (),
) -> tuple[list[dict[str, Any]], list[dict[str, Any]], float]:
    """Errors and times of `variants`, as lines that are also added to `results.jsonl`, and a yardstick [ms]; arguments
    as of `measure`, and `presets` where not all without a group are meant."""
    every = tuple(name for name, preset in phenomenon(scene).presets.items() if not preset.group)
    plan = Plan(scene, tuple(presets) or every, size=size).checked()
    study, presets = Study(session, plan), plan.presets
    machine = provenance(session.gl.info.renderer)
    results = folder / "results.jsonl"
    cases = [Case(preset, "preset", chosen) for preset in presets for chosen in variants(scene)]
    errors = sweep(results, cases, study.draw, study.truth, study.fingerprint, machine, tell)
    stick = session.gl.call(Yardstick)
    watch = Stopwatch(session, scene, TIMED_SIZE)
    times: list[dict[str, Any]] = []

    def yardstick() -> float:
        return session.gl.call(stick.draw_ms)

    try:
        for what in MOVES[1:]:
            turned = [Case(presets[0], "preset", chosen, {"moves": what}) for chosen in variants(scene)]
            times += clock(results, turned, watch.frame_ms, TIMED_SIZE, machine, yardstick, frames, tell)
    finally:
        watch.close()
    return errors, times, min(yardstick() for _ in range(QUICKEST_OF))


def facts(scene: str, errors: Lines, times: Lines, size: int, unit: float) -> dict[str, Any]:
    """The numbers by slot and kind.

    Args:
        errors, times: lines of a sweep and of a clock, over `variants`.
        size: of the pictures, pixels. unit: a yardstick [ms].

    Returns:
        `slots`: by slot and kind, `error` and `worst` (median and largest relative RMSE over the presets), and by what
        moves, `sun` and `camera`, the median frame in yardsticks and, with `_ms` behind the name, in milliseconds; what
        was not measured is left out. `note`: how, in a sentence.
    """
    slots = phenomenon(scene).slots
    default = {slot.name: slot.default for slot in slots}

    def of(lines: Lines, slot: str, kind: str) -> list[Mapping[str, Any]]:
        return [line for line in lines if line["techniques"] == {**default, slot: kind} and "failed" not in line]

    found: dict[str, dict[str, dict[str, float]]] = {}
    for slot in slots:
        for kind in techniques(scene, slot.name):
            wrong = [line["relative_rmse"] for line in of(errors, slot.name, kind)]
            numbers = {"error": float(np.median(wrong)), "worst": float(max(wrong))} if wrong else {}
            for line in of(times, slot.name, kind):
                moves = line["parameters"]["moves"]
                numbers |= {moves: line["yardsticks"], f"{moves}_ms": line["yardsticks"] * unit}
            found.setdefault(slot.name, {})[kind] = numbers
    machine = errors[0]["machine"]
    note = (
        "Measured with everything else at its default. Error: relative RMSE against the reference, median and worst of "
        f"{len({line['preset'] for line in errors})} presets, {size} px. Cost: one frame of {TIMED_SIZE[0]} x "
        f"{TIMED_SIZE[1]} while the sun or the camera moves, on {machine['renderer']}, {machine['cores']} cores, in "
        f"yardsticks: a shader of 64 texture samples a pixel, {unit:.0f} ms there."
    )
    return {"slots": found, "note": note, "machine": machine}
