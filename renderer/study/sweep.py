"""Runs many combinations of techniques against their references, and keeps every raw result.

Knows no phenomenon: the caller says which cases there are, draws them and computes their references. Results are JSON
lines, one a case, with the machine, the commit, the parameters and the seed; a sweep that was stopped goes on where it
was. Errors are of converged pictures, times of interactive frames, taken in turns so that a machine's drift hits all.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from renderer.core.cache import key_of
from renderer.core.errors import Cancelled, InputError, UmbrageError
from renderer.study.metrics import best_gain, flip, relative_rmse

WARM_UP = 3
"""Frames of each technique that are drawn and not timed: programs compile and textures arrive in the first."""

FRAMES = 30
"""Timed frames of each technique: the fewest that the project's medians and 95th percentiles are stated from."""

Progress = Callable[[float, str], None]


@dataclass(frozen=True)
class Case:
    """One combination, at one place and light.

    Attributes:
        preset, sun: names of the view and of the light.
        techniques: kind by slot.
        parameters: whatever else was set, as plain JSON values.
        seed: of everything random in it.
    """

    preset: str
    sun: str
    techniques: Mapping[str, str]
    parameters: Mapping[str, Any] = field(default_factory=dict)
    seed: int = 0


@dataclass(frozen=True)
class Drawn:
    """A converged picture, by a technique or by the reference.

    Attributes:
        linear: (H, W, 3 or 4) radiance.
        rgb8: (H, W, 3) uint8 as displayed.
        once: the same with one sample a pixel, (H, W, 3 or 4), where it is known.
        seconds: what the converged picture took.
        standard_error: of a reference, relative to its mean; 0 for a technique.
    """

    linear: NDArray[np.floating]
    rgb8: NDArray[np.uint8]
    once: NDArray[np.floating] | None = None
    seconds: float = 0.0
    standard_error: float = 0.0


def provenance(renderer: str) -> dict[str, Any]:
    """Machine and code that results come from.

    Args:
        renderer: the GL renderer string: results of different ones never share a chart.

    Raises:
        InputError: without a renderer string.
    """
    if not renderer.strip():
        raise InputError("renderer", "a result without its device says nothing")
    return {"renderer": renderer, "cores": os.cpu_count(), "system": platform.platform(),
            "python": platform.python_version(), "commit": _commit()}


def _commit() -> str:
    """The checkout's commit, with a plus sign where files differ from it; `unknown` outside a checkout."""
    folder = Path(__file__).parent
    try:
        head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=folder, capture_output=True, text=True, check=True)
        changes = subprocess.run(
            ["git", "status", "--porcelain"], cwd=folder, capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return head.stdout.strip() + ("+" if changes.stdout.strip() else "")


def read(path: Path) -> list[dict[str, Any]]:
    """The results of a file, without a last line that a killed writer left torn.

    Raises:
        InputError: another line is damaged.
    """
    if not path.is_file():
        return []
    lines = path.read_text(encoding="utf-8").split("\n")
    found = []
    for number, line in enumerate(lines, start=1):
        if not line:
            continue
        try:
            found.append(json.loads(line))
        except json.JSONDecodeError:
            if number == len(lines):
                break
            raise InputError("results", f"line {number} of {path.name} is damaged") from None
    return found


def append(path: Path, line: Mapping[str, Any]) -> None:
    """Add one line and see it to the disk; a torn end of an earlier writer is cut off first."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("ab+") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(size - 1, 0))
        if size and file.read(1) != b"\n":
            file.seek(0)
            file.truncate(file.read().rfind(b"\n") + 1)
        file.write(json.dumps(line, allow_nan=False, sort_keys=True).encode() + b"\n")
        file.flush()
        os.fsync(file.fileno())


def compare(picture: Drawn, truth: Drawn) -> dict[str, Any]:
    """The numbers of one picture against its reference.

    Returns:
        `relative_rmse`, the same after one global `gain`, and `relative_rmse_without_noise`: less the reference's own
        noise, whose variance is known and independent of the picture; FLIP's mean and 95th percentile, and the
        reference's standard error and cost. Where both were also sampled once a pixel, `pairing`: how much farther one
        frame is from its own converged picture than the reference's is (at most 1.25 for an error and a time to be
        named together).
    """
    colours = picture.linear[..., :3].astype(np.float64)
    gain = best_gain(colours, truth.linear[..., :3])
    seen = flip(picture.rgb8, truth.rgb8)
    error = relative_rmse(colours, truth.linear[..., :3])
    found = {
        "relative_rmse": error,
        "relative_rmse_without_noise": max(error**2 - truth.standard_error**2, 0.0) ** 0.5,
        "gain": gain,
        "relative_rmse_after_gain": relative_rmse(colours * gain, truth.linear[..., :3]),
        "flip_mean": seen.mean,
        "flip_p95": seen.p95,
        "reference_standard_error": truth.standard_error,
        "reference_seconds": truth.seconds,
        "size": [picture.linear.shape[1], picture.linear.shape[0]],
    }
    if picture.once is not None and truth.once is not None:
        apart = float(np.sqrt(np.mean((truth.once[..., :3] - truth.linear[..., :3]) ** 2)))
        own = float(np.sqrt(np.mean((picture.once[..., :3] - colours) ** 2)))
        found["pairing"] = own / apart if apart > 0 else None
    return found


def sweep(
    results: Path,
    cases: Sequence[Case],
    draw: Callable[[Case], Drawn],
    truth: Callable[[Case], Drawn],
    fingerprint: Callable[[Case], str],
    machine: Mapping[str, Any],
    progress: Progress | None = None,
) -> list[dict[str, Any]]:
    """Measure the error of every case that has no result yet.

    Args:
        results: the JSON lines to continue.
        cases: what to measure; those that share a reference are best neighbours, `truth` may then keep its last answer.
        draw, truth: the converged picture, and its reference at the same sub-pixel positions.
        fingerprint: text that changes when the picture may: the hash of its shader text and of its bakes. A fixed
            method cannot keep an old score.
        machine: from `provenance`.
        progress: told the share done; raises `Cancelled` to stop, and what was measured stays.

    Returns:
        The results of `cases`, in their order. A case that this machine cannot draw has `failed`, in words.
    """
    known = {line["key"]: line for line in read(results) if line["kind"] == "error"}
    found = []
    for number, case in enumerate(cases):
        if progress is not None:
            progress(number / len(cases), f"{case.preset}, {case.sun}: {' + '.join(case.techniques.values())}")
        key = key_of("error", asdict(case), fingerprint(case))
        if key not in known:
            begun = time.perf_counter()
            line = {"kind": "error", "key": key, **asdict(case), "machine": dict(machine), "when": int(time.time())}
            try:
                line |= compare(draw(case), truth(case))
            except Cancelled:
                raise
            except UmbrageError as failure:
                line["failed"] = str(failure)
            line["took_seconds"] = time.perf_counter() - begun
            append(results, line)
            known[key] = line
        found.append(known[key])
    if progress is not None:
        progress(1.0, "swept")
    return found


def clock(
    results: Path,
    cases: Sequence[Case],
    frame_ms: Callable[[Case], float],
    size: tuple[int, int],
    machine: Mapping[str, Any],
    yardstick: Callable[[], float] | None = None,
    frames: int = FRAMES,
    progress: Progress | None = None,
) -> list[dict[str, Any]]:
    """Time interactive frames of several cases in turns (A B C A B C ...), in one run.

    Args:
        results: the JSON lines to add to.
        cases: what to time.
        frame_ms: draws one frame of a case, finished, and answers its milliseconds.
        size: width and height of those frames, pixels.
        machine: from `provenance`.
        yardstick: milliseconds of the project's yardstick, taken among the frames.
        frames: timed frames of each, after the warm-up.
        progress: told the share done; raises `Cancelled` to stop.

    Returns:
        One result a case: `frame_ms` median and 95th percentile, and in `yardsticks` where there is one.
    """
    times: list[list[float]] = [[] for _ in cases]
    units: list[float] = []
    for turn in range(WARM_UP + frames):
        if progress is not None:
            progress(turn / (WARM_UP + frames), f"timing frames, turn {turn + 1}")
        for case, kept in zip(cases, times, strict=True):
            kept.append(frame_ms(case))
        if yardstick is not None:
            units.append(yardstick())
    unit = float(np.median(units[WARM_UP:])) if units else None
    found = []
    for case, kept in zip(cases, times, strict=True):
        median, p95 = np.percentile(kept[WARM_UP:], [50, 95])
        line = {"kind": "time", **asdict(case),
                "machine": dict(machine), "when": int(time.time()), "size": list(size), "warm_up": WARM_UP,
                "frames": frames,
                "frame_ms": float(median), "frame_ms_p95": float(p95), "yardstick_ms": unit,
                "yardsticks": float(median) / unit if unit else None}
        append(results, line)
        found.append(line)
    return found
